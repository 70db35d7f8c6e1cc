#pragma once

#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <optional>
#include <string>

#include "drivers/base/base_config.hpp"
#include "drivers/base/base_driver.hpp"
#include "drivers/base/line/byte_stream.hpp"
#include "drivers/base/safety/guardian.hpp"
#include "services/common/network/command_seal.hpp"
#include "services/common/process/clock.hpp"

namespace luminav {

/// What the command line of a base driver says.
struct BaseOptions {
  std::string robot_file;
  std::string device;  // "" = the robot file's
  std::string url;
  std::string state;
  double max_speed = 0.0;  // [m/s] 0 = the robot file's

  /// The exit status if the program should end now. `process` and what it does, for people.
  std::optional<int> parse(const std::string& process, const std::string& does, int argc, char** argv);
  /// Puts the limit of the command line in force. Throws ConfigurationError.
  void limit(MotionLimits& limits) const;
  /// Puts all of it in force, and says what the guardian of such a robot is to do. Throws ConfigurationError.
  GuardianParams apply_to(BaseConfig& config) const;
};

/// How long a guardian may let the robot brake [s].
double brake_time_of(const MotionLimits& limits);
/// After so much silence of its driver [s] it has left the line.
double done_after_of(const GuardianParams& guarding);

using MakeDriver = std::function<std::unique_ptr<BaseDriver>(lcm::LCM&, const Clock&, std::optional<CommandKey>)>;

/// Runs a driver with its guardian until it is told to end; the exit status. To be called before there are threads.
int run_base(const std::string& process, const BaseOptions& options, const std::string& robot,
             const GuardedRobot& guarded, const GuardianParams& guarding, const MakeDriver& make_driver);

/// stream_opener, for a configuration. Throws ConfigurationError.
OpenStream open_by_configuration(const std::string& device, int baud);

}  // namespace luminav
