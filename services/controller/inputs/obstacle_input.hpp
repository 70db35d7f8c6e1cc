#pragma once

#include <functional>
#include <luminav/sonar_t.hpp>
#include <optional>
#include <string>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/controller/controller.hpp"
#include "services/controller/inputs/recent_odometry.hpp"
#include "services/controller/safety/echo_memory.hpp"
#include "services/controller/safety/sonar_watch.hpp"
#include "services/controller/safety/touch_memory.hpp"

namespace luminav {

/// The mapper's grid in the odometry's frame, while the pose is known.
struct PlacedGrid {
  const OccupancyGrid& grid;
  Pose2 world_from_odom;
};

/// What the robot has heard and felt of things around it, and whether its sonars are to be believed.
class ObstacleInput {
 public:
  ObstacleInput(const RobotDescription& robot, const EchoMemoryParams& memory)
      : echoes_(robot.sonar, memory), sonar_watch_(robot.sonar), touches_(robot) {}

  /// Takes up what each disc tells for the first time. `drop` is told of what cannot be.
  void take(const sonar_t& message, const RecentOdometry& odometry, const std::optional<PlacedGrid>& map,
            const std::function<void(const char*)>& drop);
  /// A wheel is blocked or a bumper pressed, and was not before, while the robot drove with `twist`.
  void feel(std::int64_t utime, const Pose2& odom_from_robot, const DriveTwist& twist) {
    touches_.add(utime, odom_from_robot, twist);
  }
  /// The odometry jumped.
  void clear();

  /// Writes what a control step has to know of it: obstacles as they are seen from `odom_from_robot`, for the task that
  /// stands there.
  void describe(std::int64_t utime, const Pose2& odom_from_robot, ControlInput& input) const;
  /// Writes how old it is and what is to be thought of it.
  void judge(std::int64_t utime, SenseAges& ages) const;

  [[nodiscard]] SonarTrust trust() const { return sonar_watch_.trust(); }
  /// Plain sentence; "" when trusted.
  [[nodiscard]] std::string reason() const { return sonar_watch_.reason(); }

 private:
  /// What the building's map leads a disc of a robot that stands there to expect.
  [[nodiscard]] SonarWatch::Place expect(std::size_t disc, const Pose2& world_from_robot,
                                         const OccupancyGrid& grid) const;

  EchoMemory echoes_;
  SonarWatch sonar_watch_;
  TouchMemory touches_;
};

}  // namespace luminav
