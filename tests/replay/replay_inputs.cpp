#include "tests/replay/replay_inputs.hpp"

#include <fmt/format.h>

#include <luminav/fixture_detections_t.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <stdexcept>

#include "services/common/log/log_message.hpp"
#include "services/common/process/channels.hpp"
#include "tests/replay/log_reading/message_schema.hpp"
#include "tests/replay/replay_nodes.hpp"

namespace luminav {
namespace {

/// Which channels a log has.
std::set<std::string> contents_of(const std::string& file) {
  std::set<std::string> contents;
  LogReader log(file);
  log.load_only({});
  LogEvent event;
  // a camera may come late; what decides has mostly spoken within a second
  while (!(contents.contains(channels::kCameraImage) && contents.contains(channels::kOdometry)) && log.next(event)) {
    contents.insert(event.channel);
  }
  return contents;
}

}  // namespace

std::set<std::string> nodes_for(const ReplayOptions& options) {
  const std::set<std::string> contents = contents_of(options.log_file);
  std::set<std::string> nodes = options.nodes;
  if (nodes.empty()) {
    nodes.insert(replayable_nodes().begin(), replayable_nodes().end());
    if (!contents.contains(channels::kCameraImage)) {
      nodes.erase("detector");
    }
  }
  for (const std::string& node : nodes) {
    const std::string channel = node == "detector" ? channels::kCameraImage : channels::kOdometry;
    if (!contents.contains(channel)) {
      throw std::runtime_error(
          fmt::format("{}: has no {}, so the {} cannot be replayed", options.log_file, channel, node));
    }
  }
  return nodes;
}

bool ReplayInputs::admit(LogEvent& event) {
  if (!is_of_our_version(event)) {
    return false;
  }
  if (event.channel == channels::kMapCommand) {
    return only_clears(event);
  }
  if (event.channel == channels::kRobotStatus) {
    note_robot(event);
  } else if (event.channel == channels::kFixtureDetections && camera_shift_ != 0.0) {
    shift(event);
  }
  return true;
}

double ReplayInputs::elapsed(const LogEvent& event) const {
  return static_cast<double>(event.utime - report_.first_utime) * 1e-6;
}

bool ReplayInputs::is_of_our_version(const LogEvent& event) {
  if (MessageSchemas::built_in().find(event.fingerprint()) != nullptr) {
    return true;
  }
  if (foreign_.insert(event.channel).second) {
    report_.failures.push_back(
        fmt::format("{}: recorded with another version of its type (fingerprint {:016x}), {:.1f} s after the start",
                    event.channel, event.fingerprint(), elapsed(event)));
  }
  return false;
}

bool ReplayInputs::only_clears(const LogEvent& event) {
  const auto command = decoded<map_command_t>(event.data);
  if (command && command->action == map_command_t::ACTION_CLEAR_EVIDENCE) {
    return true;
  }
  report_.remarks.push_back(
      fmt::format("MAP_COMMAND {:.1f} s after the start left out: it loads or saves a file", elapsed(event)));
  return false;
}

void ReplayInputs::note_robot(const LogEvent& event) {
  const auto status = decoded<robot_status_t>(event.data);
  if (status && robots_.insert(status->robot).second && robots_.size() == 2) {
    report_.failures.push_back(
        fmt::format("two robots are in the log ({}), their messages cannot be told apart", fmt::join(robots_, ", ")));
  }
}

void ReplayInputs::shift(LogEvent& event) const {
  if (auto detections = decoded<fixture_detections_t>(event.data)) {
    for (fixture_detection_t& detection : detections->detections) {
      detection.x += camera_shift_;
    }
    event.data = encoded(*detections);
  }
}

}  // namespace luminav
