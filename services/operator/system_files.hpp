#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/node_status_t.hpp>
#include <string>

#include "services/common/process/running_system.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// Paths of a robot's and a building's file; "" = none.
struct FilePaths {
  std::string robot;
  std::string building;
};

/// Hears which files the running system was given. Reads no clock: all that it hears is of now.
class SystemListener {
 public:
  explicit SystemListener(lcm::LCM& lcm);

  [[nodiscard]] const RunningSystem& system() const { return system_; }

 private:
  void on_node_status(const node_status_t& status) { system_.hear(status, 0); }

  RunningSystem system_;
  Subscriber subscriber_;
};

/// The files to use with what runs: those a person asked for, else the running system's, wherever on this machine they
/// lie; else, where nothing runs, the launched ones ($LUMINAV_ROBOT, $LUMINAV_BUILDING, $LUMINAV_SCENARIO) or those
/// that come with the project. Throws ConfigurationError where a person asked for other files than the running ones,
/// where its processes were given different ones, and where the running ones are not on this machine.
FilePaths choose_files(const RunningSystem& system, const FilePaths& asked);

}  // namespace luminav
