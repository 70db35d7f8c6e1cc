#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/robot_status_t.hpp>
#include <mutex>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/network/command_seal.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {

/// A person's hand on the robot: sends TELEOP_COMMAND for each steering that a page sends while somebody holds the
/// stick, ten a second. Dead-man: whoever lets go, or loses the connection, sends none, and the controller stops the
/// robot 0.3 s after the last. One person at a time. Thread-safe; reads no clock.
class Helm {
 public:
  Helm(lcm::LCM& lcm, const MotionLimits& limits, std::optional<CommandKey> key = {})
      : commands_(lcm, key), limits_(limits) {}

  /// Its stamp goes into the commands: they answer the newest word of the robot.
  void on_robot_status(const robot_status_t& message);

  /// Throws RequestError when it comes too late (a backlog is never fresh) or out of order, is faster than the robot,
  /// while another person steers, and when no robot was heard.
  void steer(const Steering& steering, std::int64_t now);

 private:
  static constexpr std::int64_t kFresh = 300'000;     // [us] since the page saw what it answers
  static constexpr std::int64_t kHandOver = 500'000;  // [us] of rest before another person may steer

  CommandPublisher commands_;
  const MotionLimits limits_;
  std::mutex mutex_;
  std::int64_t robot_utime_ = 0;
  std::int64_t session_ = 0;   // of the page that steers or steered last
  std::int32_t sequence_ = 0;  // of its last command
  std::int64_t steered_ = 0;   // [us] when that came
};

}  // namespace luminav
