#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/controller/safety/obstacles.hpp"
#include "services/controller/safety/sonar_firing.hpp"

namespace luminav {

struct EchoMemoryParams {
  double keep = 1.2;  // [s] an echo that nothing refutes
};

/// Tells whether a mapped wall is within a distance [m] of a point. Arguments: point in odom, distance.
using WallTest = std::function<bool(const Eigen::Vector2d&, double)>;

/// What the sonars heard lately, in the odometry frame. A disc fires every 0.32 s only, so a reading has to live on
/// while the robot moves. One echo says: something at this range, anywhere on the arc. Of the arc only the part that no
/// neighbour's axis is nearer to is kept: together these parts cover all directions, and a doorway stays open.
class EchoMemory {
 public:
  EchoMemory(const SonarRing& ring, const EchoMemoryParams& params);

  /// Takes up a firing; `is_wall` may be empty (pose or map unknown).
  void add(const SonarFiring& firing, const WallTest& is_wall);
  /// Obstacles as they are seen from the robot now.
  [[nodiscard]] std::vector<ObstaclePoint> obstacles(std::int64_t now, const Pose2& odom_from_robot) const;
  /// Obstacles of a robot that doesn't know where it is: no map tells of the door jamb beside its rear corner, where no
  /// disc looks, so what was near is remembered longer.
  [[nodiscard]] std::vector<ObstaclePoint> obstacles_without_map(std::int64_t now, const Pose2& odom_from_robot) const;
  /// Obstacles with a longer memory, for choosing a direction: standing things stay where they are.
  [[nodiscard]] std::vector<ObstaclePoint> remembered(std::int64_t now, const Pose2& odom_from_robot) const;
  /// Newest firing of each disc; utime 0 = never.
  [[nodiscard]] const std::vector<SonarFiring>& newest() const { return newest_; }
  [[nodiscard]] const SonarRing& ring() const { return ring_; }
  /// The odometry jumped: nothing remembered has a place any more.
  void clear();

 private:
  struct Sector {
    double right = 0.0;  // [rad] from the axis, not positive
    double left = 0.0;   // [rad]
  };
  struct Echo {
    std::int64_t utime = 0;
    std::size_t disc = 0;
    double range = 0.0;         // [m]
    Pose2 odom_from_robot;      // when it was heard
    double keep = 0.0;          // [s]
    double approach = 0.0;      // [m/s]
    double axis_in_odom = 0.0;  // [rad] of the disc that heard it
    bool is_known = false;
    bool has_stood = false;
    bool may_be_gone = false;  // what was heard beside it has gone
    std::vector<Eigen::Vector2d> points_in_odom;
  };
  [[nodiscard]] std::vector<ObstaclePoint> points_of(std::int64_t now, const Pose2& odom_from_robot, double longest,
                                                     double longest_near) const;
  [[nodiscard]] bool was_heard_before(const Echo& echo) const;
  [[nodiscard]] double approach_speed(const SonarFiring& firing) const;
  [[nodiscard]] bool repeats_itself(const SonarFiring& firing) const;
  void keep_longer(std::size_t disc);
  void refute(const SonarFiring& firing);
  /// Forgets sooner what other echoes, from other headings and by other discs, say of places [m, odom] where something
  /// has gone: as soon as what never stood.
  void remember_less_beside(const std::vector<Eigen::Vector2d>& gone);

  SonarRing ring_;
  EchoMemoryParams params_;
  std::vector<Sector> sectors_;
  std::vector<SonarFiring> newest_;
  std::vector<bool> approaching_;  // the last firing of the disc gave a sign of approach
  std::vector<Echo> echoes_;
};

}  // namespace luminav
