#include "services/viewer/playback/log_index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <luminav/goal_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kRecent = 1'000'000;  // [us] poses and pictures belong together over half a second
constexpr std::size_t kMaxMarks = 2000;      // of a log that is damaged, or of a robot that was

}  // namespace

const char* name_of(LogIndex::Mark::Kind kind) {
  switch (kind) {
    case LogIndex::Mark::Kind::kGoal:
      return "goal";
    case LogIndex::Mark::Kind::kStop:
      return "stop";
    case LogIndex::Mark::Kind::kLost:
      return "lost";
  }
  return "";
}

LogIndex::LogIndex(LogReader& reader) {
  reader.load_only(
      {channels::kPose, channels::kGoal, channels::kRobotStatus, channels::kGridTile, channels::kNodeStatus});
  LogEvent event;
  std::int64_t at = 0;
  std::int64_t last = 0;
  for (std::uint64_t position = 0; reader.next(event); position = reader.position()) {
    if (entries_.empty()) {
      begin_ = last = event.utime;
    }
    at += std::max<std::int64_t>(0, event.utime - last);
    last = event.utime;
    entries_.push_back({at, position, subject_of(event)});
    mark(event, at);
  }
}

std::size_t LogIndex::subject_of(const LogEvent& event) {
  std::string subject = event.channel;
  if (event.channel == channels::kGridTile) {
    if (const auto tile = decoded<grid_tile_t>(event.data)) {
      subject += fmt::format(" {} {}", tile->tile_column, tile->tile_row);
    }
  } else if (event.channel == channels::kNodeStatus) {
    if (const auto status = decoded<node_status_t>(event.data)) {
      subject += fmt::format(" {}@{}", status->process, status->host);
    }
  }
  return subjects_.try_emplace(subject, subjects_.size()).first->second;
}

void LogIndex::mark(const LogEvent& event, std::int64_t at) {
  if (marks_.size() >= kMaxMarks) {
    return;
  }
  if (event.channel == channels::kPose) {
    mark_pose(event, at);
  } else if (event.channel == channels::kGoal) {
    mark_goal(event, at);
  } else if (event.channel == channels::kRobotStatus) {
    mark_stop(event, at);
  }
}

void LogIndex::mark_pose(const LogEvent& event, std::int64_t at) {
  const auto pose = decoded<pose_t>(event.data);
  if (!pose) {
    return;
  }
  const bool is_tracking = pose->state == pose_t::STATE_TRACKING;
  if (was_tracking_ && !is_tracking) {
    marks_.push_back({at, Mark::Kind::kLost, pose->reason});
  }
  was_tracking_ = is_tracking;
}

// A goal is repeated until the planner has taken it up.
void LogIndex::mark_goal(const LogEvent& event, std::int64_t at) {
  const auto goal = decoded<goal_t>(event.data);
  if (!goal || goal->id == goal_id_) {
    return;
  }
  goal_id_ = goal->id;
  if (goal->action != goal_t::ACTION_GO || goal->poses.empty()) {
    return;
  }
  const goal_pose_t& first = goal->poses.front();
  std::string text = first.place.empty() ? fmt::format("({:.1f}, {:.1f})", first.x, first.y) : first.place;
  if (goal->poses.size() > 1) {
    text += fmt::format(" + {}", goal->poses.size() - 1);
  }
  marks_.push_back({at, Mark::Kind::kGoal, std::move(text)});
}

// By the robot's own word: a request may have been lost, and the button on the robot sends none.
void LogIndex::mark_stop(const LogEvent& event, std::int64_t at) {
  const auto status = decoded<robot_status_t>(event.data);
  if (!status) {
    return;
  }
  const bool is_stopped = status->stop_engaged != 0 || status->stop_button != 0;
  if (is_stopped && !was_stopped_) {
    marks_.push_back({at, Mark::Kind::kStop, status->reason});
  }
  was_stopped_ = is_stopped;
}

std::size_t LogIndex::count_until(std::int64_t at) const {
  const auto end = std::upper_bound(entries_.begin(), entries_.end(), at,
                                    [](std::int64_t value, const Entry& entry) { return value < entry.at; });
  return static_cast<std::size_t>(end - entries_.begin());
}

std::vector<LogIndex::Entry> LogIndex::needed_at(std::int64_t at) const {
  const std::size_t count = count_until(at);
  std::vector<std::size_t> newest(subjects_.size(), entries_.size());
  for (std::size_t i = 0; i < count; ++i) {
    newest[entries_[i].subject] = i;
  }
  std::vector<Entry> needed;
  for (std::size_t i = 0; i < count; ++i) {
    const Entry& entry = entries_[i];
    if (newest[entry.subject] == i || entry.at > at - kRecent) {
      needed.push_back(entry);
    }
  }
  return needed;
}

}  // namespace luminav
