#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "drivers/simulator/world/scenario.hpp"
#include "drivers/simulator/world/world.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/building.hpp"
#include "services/common/calendar/local_time.hpp"

namespace luminav {

class DetectorBehaviour;

struct WholeRobotOptions {
  std::string mode;  // "paper" or "modern", of all nodes that have both; "" = as the robot's file says
  bool jpeg = true;  // pictures are compressed as on the network; false: mono8
  const DetectorBehaviour* geometric = nullptr;  // what geometric sensing draws from, instead of camera and detector
  std::string survey_folder{};  // where a surveyor writes that explores, instead of detector, localizer and
  std::string kinds_file{};     // mapper, with these kinds of fixture; "" = nobody surveys
};

/// All drivers and services, the true nodes, in one program: one memq:// handle, one virtual clock, the serial line a
/// pipe in memory; the job service where the scenario has jobs. Same scenario, same messages.
class WholeRobot {
 public:
  /// Throws ConfigurationError for what the files have wrong.
  WholeRobot(const Scenario& scenario, const WholeRobotOptions& options);
  ~WholeRobot();

  [[nodiscard]] lcm::LCM& lcm();
  [[nodiscard]] const WorldTruth& world() const;
  /// The world as it goes on; people may be put into it.
  [[nodiscard]] World& simulated_world();
  [[nodiscard]] const Building& believed_building() const;
  [[nodiscard]] const RobotDescription& believed_robot() const;
  [[nodiscard]] std::int64_t utime() const;  // [us]
  /// The time of day in the building: it begins on a Monday at eight, on every machine.
  [[nodiscard]] LocalClock local_clock() const;

  /// The survey is written; false where there is none.
  [[nodiscard]] bool has_surveyed() const;

  /// Time goes on by 10 ms.
  void step();
  /// The process loses all it knew and starts anew, as after a crash. Unknown names throw std::invalid_argument.
  void restart(const std::string& process);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace luminav
