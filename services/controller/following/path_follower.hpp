#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/controller/following/lookahead.hpp"
#include "services/controller/following/speed_law.hpp"
#include "services/controller/following/steady_heading.hpp"
#include "services/controller/following/virtual_forces.hpp"
#include "services/controller/safety/stop_logic.hpp"

namespace luminav {

/// A path to a goal, in the world frame.
struct FollowedPath {
  std::int64_t goal_id = 0;
  int pose_index = 0;
  int sequence = 0;
  std::vector<Eigen::Vector2d> points;  // [m] world; empty = stand still
  double tolerance = 0.1;               // [m] around the last point
  bool has_theta = false;
  double theta = 0.0;                       // [rad] world
  double heading_tolerance = radians(5.0);  // [rad]
};

struct PathFollowerParams {
  LookAheadParams look_ahead;
  VirtualForceParams forces;
  SteadyHeadingParams heading;
  SpeedLawParams speed;
  double arrival_radius = 0.04;           // [m] from the last point
  double arrival_heading = radians(1.5);  // [rad] from the final heading
};

/// What the follower sees.
struct FollowSituation {
  const Obstacles& obstacles;
  Pose2 world_from_robot = {};
  std::optional<double> lane = {};  // [rad] world: direction of the one-way zone in which it is
  LineTest is_line_free = {};       // in the world's grid
  bool may_back = false;            // rear sonars see
  double duration = 0.05;           // [s] since the last step
};

enum class FollowPhase { kNoPath, kDriving, kTurning, kAtGoal };

struct FollowStep {
  FollowPhase phase = FollowPhase::kNoPath;
  DriveTwist wanted;
  std::optional<LookAhead> look_ahead;
  VirtualForce force;
  double heading_error = 0.0;  // [rad] to where it wants to go
};

/// Follows a path: look-ahead goal, virtual forces, free heading, speed law; then the last centimetres and the final
/// heading. It wishes only; the stop logic has the last word.
class PathFollower {
 public:
  PathFollower(const PathFollowerParams& params, const StopLogic& stop_logic)
      : params_(params), stop_logic_(stop_logic), heading_(params.heading) {}

  /// A path that ends where the last one did keeps "arrived".
  void set_path(const FollowedPath& path);
  void clear();
  [[nodiscard]] const FollowedPath& path() const { return path_; }

  FollowStep step(const FollowSituation& situation);
  /// Within the tolerance of the path's end: good enough when there is no getting nearer.
  [[nodiscard]] bool is_within_tolerance(const Pose2& world_from_robot) const;
  /// Accepts the place where it stands as arrived.
  void settle() { is_placed_ = true; }

 private:
  void approach(const FollowSituation& situation, FollowStep& step);
  void drive(const FollowSituation& situation, FollowStep& step);
  void take_final_heading(const FollowSituation& situation, FollowStep& step);
  /// Turning speed towards a heading error, the long way round where the short one is blocked.
  double turn_on_the_spot(double error, const FollowSituation& situation);

  PathFollowerParams params_;
  const StopLogic& stop_logic_;
  FollowedPath path_;
  double travelled_ = 0.0;  // [m] of the path
  bool is_placed_ = false;  // the last point was reached
  bool is_aligned_ = false;
  bool is_turning_ = false;
  bool is_backing_ = false;
  int long_turn_ = 0;                                    // 0 = the short turn, else the sign of the long one
  double nearest_ = 1e9;                                 // [m] that it came to the last point
  SteadyHeading heading_;                                // in the world
  Eigen::Vector2d repulsive_ = Eigen::Vector2d::Zero();  // smoothed, robot frame
};

}  // namespace luminav
