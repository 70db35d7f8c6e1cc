#include "tests/replay/log_reading/log_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <luminav/map_command_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

double seconds(std::int64_t microseconds) {
  return static_cast<double>(microseconds) * 1e-6;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) {
    return 0.0;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::string milliseconds(double value) {
  return fmt::format("{:.1f}", 1e3 * value);
}

template <typename Message>
std::optional<Message> decoded(const LogEvent& event) {
  Message message{};
  if (message.decode(event.data.data(), 0, static_cast<int>(event.data.size())) < 0) {
    return std::nullopt;
  }
  return message;
}

}  // namespace

double ChannelSurvey::rate() const {
  return count > 1 && last > first ? static_cast<double>(count - 1) / seconds(last - first) : 0.0;
}

double ChannelSurvey::jitter() const {
  if (intervals.size() < 2) {
    return 0.0;
  }
  double sum = 0.0;
  double square_sum = 0.0;
  for (const double interval : intervals) {
    sum += interval;
    square_sum += interval * interval;
  }
  const auto n = static_cast<double>(intervals.size());
  return std::sqrt(std::max(0.0, square_sum / n - (sum / n) * (sum / n)));
}

void LogSurvey::add(const LogEvent& event) {
  first_ = events_ == 0 ? event.utime : first_;
  backward_ += events_ > 0 && event.utime < last_ ? 1 : 0;
  last_ = event.utime;
  ++events_;
  ChannelSurvey& channel = channels_[event.channel];
  if (channel.count == 0) {
    channel.first = event.utime;
    channel.fingerprint = event.fingerprint();
    if (const TypeSchema* type = schemas_.find(channel.fingerprint)) {
      channel.type = type->name;
    }
  } else {
    const double interval = seconds(event.utime - channel.last);
    channel.intervals.push_back(interval);
    if (interval > channel.longest_gap) {
      channel.longest_gap = interval;
      channel.longest_gap_at = channel.last;
    }
  }
  ++channel.count;
  channel.bytes += static_cast<std::int64_t>(event.data.size());
  channel.last = event.utime;
  if (event.fingerprint() != channel.fingerprint || (!channel.type.empty() && !schemas_.decode(event.data, 0))) {
    ++channel.undecodable;
    return;
  }
  if (const auto stamp = schemas_.integer(event.data, "utime")) {
    channel.latencies.push_back(seconds(event.utime - *stamp));
    // each tile has a stamp of its own, and goes out again as it is
    const bool is_older = channel.newest_stamp && *stamp < *channel.newest_stamp && channel.type != "grid_tile_t";
    channel.out_of_order += is_older ? 1 : 0;
    channel.newest_stamp = std::max(*stamp, channel.newest_stamp.value_or(*stamp));
  }
  follow_sequence(channel, event);
  look_inside(event);
}

void LogSurvey::follow_sequence(ChannelSurvey& channel, const LogEvent& event) {
  const auto session = schemas_.integer(event.data, "session");
  const bool same_session = session == channel.session;
  const bool connected = session && *session != 0;  // 0: no robot is connected, before, between and after sessions
  if (connected && !same_session) {
    channel.mixed_senders = channel.mixed_senders || !channel.sessions.insert(*session).second;
  }
  if (connected) {
    channel.session = session;
  }
  const auto sequence = schemas_.integer(event.data, "sequence");
  if (sequence && channel.sequence && same_session) {
    // a PATH's number counts the plans, not all of which are sent
    if (*sequence > *channel.sequence + 1 && channel.type != "path_t") {
      channel.lost += *sequence - *channel.sequence - 1;
    } else if (*sequence < *channel.sequence) {
      ++channel.restarts;
    }
  }
  channel.sequence = sequence;
}

void LogSurvey::look_inside(const LogEvent& event) {
  if (event.channel == channels::kRobotStatus) {
    if (const auto status = decoded<robot_status_t>(event)) {
      robots_.insert(status->robot);
    }
  } else if (event.channel == channels::kPose && channels_[event.channel].count == 1) {
    const auto pose = decoded<pose_t>(event);
    tracking_at_start_ = pose && pose->state == pose_t::STATE_TRACKING;
  } else if (event.channel == channels::kMapCommand) {
    const auto command = decoded<map_command_t>(event);
    saves_ += command && command->action != map_command_t::ACTION_CLEAR_EVIDENCE ? 1 : 0;
  }
}

std::vector<std::string> LogSurvey::objections() const {
  std::vector<std::string> list;
  if (robots_.size() > 1) {
    std::string names;
    for (const std::string& robot : robots_) {
      names += (names.empty() ? "" : ", ") + robot;
    }
    list.push_back(
        fmt::format("there are {} robots in it ({}): their messages cannot be told apart", robots_.size(), names));
  }
  if (backward_ > 0) {
    list.push_back(fmt::format("the logger's clock went back {} times", backward_));
  }
  for (const auto& [name, channel] : channels_) {
    if (channel.type.empty() && name != "LCM_SELF_TEST") {  // that one is LCM's own
      list.push_back(
          fmt::format("{}: no known type has the fingerprint {:016x}: recorded with another version, or foreign", name,
                      channel.fingerprint));
    }
    if (channel.undecodable > 0) {
      list.push_back(fmt::format("{}: {} messages do not decode", name, channel.undecodable));
    }
    if (channel.mixed_senders) {
      list.push_back(fmt::format("{}: two senders at the same time ({} sessions)", name, channel.sessions.size()));
    }
    if (channel.out_of_order > 0) {
      list.push_back(fmt::format("{}: {} stamps are older than one before them; nodes drop such messages", name,
                                 channel.out_of_order));
    }
    if (channel.lost > 0) {
      list.push_back(fmt::format("{}: {} messages are missing; the nodes may have heard them", name, channel.lost));
    }
  }
  if (!channels_.contains(channels::kCameraImage)) {
    list.emplace_back("no CAMERA_IMAGE: the detector cannot be replayed, FIXTURE_DETECTIONS are taken from the log");
  }
  if (tracking_at_start_) {
    list.emplace_back("the robot knew its pose before the log begins: a replayed localizer starts lost");
  }
  if (saves_ > 0) {
    list.push_back(fmt::format("{} MAP_COMMANDs load or save files: a replay leaves them out", saves_));
  }
  return list;
}

std::string LogSurvey::text() const {
  std::string text = fmt::format("{} messages on {} channels in {:.1f} s, from {} us\n\n", events_, channels_.size(),
                                 seconds(last_ - first_), first_);
  text += fmt::format("{:<20} {:<22} {:>7} {:>7} {:>8} {:>9} {:>9} {:>10} {:>6} {:>6} {:>7} {:>27}\n", "channel",
                      "type", "count", "Hz", "jitter", "gap s", "at s", "kB", "order", "lost", "restart",
                      "latency ms (p50, p95, max)");
  for (const auto& [name, c] : channels_) {
    const std::string type = c.type.empty() ? fmt::format("? {:016x}", c.fingerprint) : c.type;
    std::string latency = "-";
    if (!c.latencies.empty()) {
      latency = fmt::format("{} {:>8} {:>8}", milliseconds(quantile(c.latencies, 0.5)),
                            milliseconds(quantile(c.latencies, 0.95)),
                            milliseconds(*std::max_element(c.latencies.begin(), c.latencies.end())));
    }
    text += fmt::format("{:<20} {:<22} {:>7} {:>7.2f} {:>8} {:>9.3f} {:>9.1f} {:>10.1f} {:>6} {:>6} {:>7} {:>27}\n",
                        name, type, c.count, c.rate(), milliseconds(c.jitter()), c.longest_gap,
                        c.longest_gap_at == 0 ? 0.0 : seconds(c.longest_gap_at - first_),
                        static_cast<double>(c.bytes) * 1e-3, c.out_of_order, c.lost, c.restarts, latency);
  }
  text +=
      "\njitter: ms, deviation of the intervals. order: stamps older than one before. lost: by gaps of the sequence.\n"
      "latency: from the stamp of the sensor's data, which every stage copies, to the logger; true where both clocks "
      "are one.\n";
  const std::vector<std::string> list = objections();
  text += list.empty() ? "\nNothing found that makes a replay differ.\n" : "\nA replay may differ, because\n";
  for (const std::string& objection : list) {
    text += "  " + objection + "\n";
  }
  return text;
}

}  // namespace luminav
