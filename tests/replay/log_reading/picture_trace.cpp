#include "tests/replay/log_reading/picture_trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/pose_t.hpp>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kTimeOffset = 33'000;  // [us] by which a POSE's stamp of its picture may differ from that one's
constexpr std::int64_t kPatience = 200'000;   // [us] a command that comes later was given for another reason

}  // namespace

double PictureTrace::Stage::quantile(double share) const {
  std::vector<double> sorted = seconds;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

void PictureTrace::add(const LogEvent& event) {
  if (event.channel == channels::kCameraImage) {
    if (const auto image = decoded<camera_image_t>(event.data)) {
      Passage& passage = passages_[image->utime];
      passage[kTaken] = image->utime;
      passage[kArrived] = arrival_ ? arrival_(*image) : 0;
      passage[kPicture] = event.utime;
    }
  } else if (event.channel == channels::kFixtureDetections) {
    if (const auto detections = decoded<fixture_detections_t>(event.data)) {
      Passage& passage = passages_[detections->utime];
      passage[kTaken] = detections->utime;
      passage[kDetections] = event.utime;
    }
  } else if (event.channel == channels::kPose) {
    const auto pose = decoded<pose_t>(event.data);
    Passage* const passage = pose && pose->state == pose_t::STATE_TRACKING && pose->fixture_utime > used_
                                 ? nearest(pose->fixture_utime)
                                 : nullptr;
    if (passage != nullptr) {
      used_ = pose->fixture_utime;
      (*passage)[kPose] = event.utime;
      awaited_ = passage;
    }
  } else if (event.channel == channels::kVelocityCommand) {
    if (const auto command = decoded<velocity_command_t>(event.data)) {
      hear_command(event.utime, *command);
    }
  }
}

// Between two steps of control the last command is repeated: one that differs was computed after the POSE, and so was
// one of the same stamp, which is given for a POSE alone.
void PictureTrace::hear_command(std::int64_t heard, const velocity_command_t& command) {
  const bool is_new =
      last_command_ && (command.utime == last_command_->utime || command.linear_x != last_command_->linear_x ||
                        command.angular_z != last_command_->angular_z);
  last_command_ = command;
  if (awaited_ == nullptr) {
    return;
  }
  const bool is_late = heard - (*awaited_)[kPose] > kPatience;
  if (is_new && !is_late) {
    (*awaited_)[kCommand] = heard;
  }
  if (is_new || is_late) {
    awaited_ = nullptr;
  }
}

PictureTrace::Passage* PictureTrace::nearest(std::int64_t utime) {
  auto after = passages_.lower_bound(utime);
  if (after == passages_.end() ||
      (after != passages_.begin() && utime - std::prev(after)->first < after->first - utime)) {
    after = after == passages_.begin() ? passages_.end() : std::prev(after);
  }
  return after == passages_.end() || std::abs(after->first - utime) > kTimeOffset ? nullptr : &after->second;
}

PictureTrace::Stage PictureTrace::stage(const std::string& name, Mark from, Mark to) const {
  Stage stage{name, {}};
  for (const auto& [utime, passage] : passages_) {
    if (passage[from] != 0 && passage[to] != 0) {
      stage.seconds.push_back(1e-6 * static_cast<double>(passage[to] - passage[from]));
    }
  }
  return stage;
}

std::vector<PictureTrace::Stage> PictureTrace::stages() const {
  std::vector<Stage> list = {stage("taken_to_arrival", kTaken, kArrived),
                             stage("arrival_to_picture", kArrived, kPicture),
                             stage("picture_to_detections", kPicture, kDetections),
                             stage("detections_to_pose", kDetections, kPose),
                             stage("pose_to_command", kPose, kCommand),
                             stage("image_to_detections", kTaken, kDetections),
                             stage("image_to_pose", kTaken, kPose),
                             stage("image_to_command", kTaken, kCommand),
                             stage("arrival_to_command", kArrived, kCommand)};
  list.erase(std::remove_if(list.begin(), list.end(), [](const Stage& s) { return s.seconds.empty(); }), list.end());
  return list;
}

std::string PictureTrace::text() const {
  std::string text;
  for (const Stage& s : stages()) {
    text += fmt::format("{:<24} {:>8} {:>8.1f} {:>8.1f}\n", s.name, s.seconds.size(), 1e3 * s.quantile(0.5),
                        1e3 * s.quantile(0.99));
  }
  return text.empty() ? text
                      : fmt::format("{:<24} {:>8} {:>8} {:>8}\n", "picture, ms", "count", "median", "99 %") + text;
}

}  // namespace luminav
