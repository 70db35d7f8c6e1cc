#pragma once

#include <cstdint>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/controller/safety/echo_memory.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav {

/// What blocked the wheels or pressed a bumper though no sonar heard it, a table's edge or a glass door: it stands
/// before the side that drove against it. Kept in the odometry frame.
class TouchMemory {
 public:
  static constexpr std::size_t kMax = 20;  ///< touches remembered

  explicit TouchMemory(const RobotDescription& robot);

  /// The robot was blocked while it drove with `twist`. A turn on the spot leaves nothing: any corner may have touched.
  void add(std::int64_t now, const Pose2& odom_from_robot, const DriveTwist& twist);
  /// Appends what is remembered, in the robot frame.
  void append(std::int64_t now, const Pose2& odom_from_robot, std::vector<ObstaclePoint>& obstacles) const;
  /// The odometry jumped: nothing remembered has a place any more.
  void clear() { touches_.clear(); }

 private:
  struct Touch {
    std::int64_t utime = 0;
    std::vector<Eigen::Vector2d> points_in_odom;
  };
  double front_ = 0.0;       // [m] of the outline
  double rear_ = 0.0;        // [m], negative
  double half_width_ = 0.0;  // [m]
  std::vector<Touch> touches_;
};

}  // namespace luminav
