#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/planner/goals/issued_path.hpp"
#include "services/planner/goals/route_map.hpp"
#include "services/planner/holding/blockage.hpp"

namespace luminav {

/// Where the robot waits for a path that is blocked, how long, and what it does meanwhile: it faces what blocks, lets
/// people out of a door, and looks again from elsewhere. What it wants the controller to do it returns as an order.
class BlockageHold {
 public:
  BlockageHold(const GoalParams& params, std::vector<Door> doors);

  /// A new stop.
  void reset() { waits_beside_ = 0; }
  /// The clock started anew.
  void restart_clock(std::int64_t now);

  /// Begins to wait before point `blocked_at` of a path; `reference_length` [m] is what a detour is compared with.
  [[nodiscard]] PathOrder begin(const RouteMap& map, const Polyline& path, std::size_t blocked_at,
                                double reference_length, std::int64_t now);
  /// What it waits before is a gap: it is looked at for a few seconds.
  void look_at_gap() { is_look_ = true; }
  /// Leaves the opening of a door, if the place to wait is in one and there is room beside it.
  [[nodiscard]] std::optional<PathOrder> leave_opening(RouteMap& map, std::int64_t now);

  /// Notes when the robot has come to its place.
  void update(const IssuedPath& path, const Situation& situation);
  [[nodiscard]] bool has_waited(std::int64_t now) const;
  [[nodiscard]] bool has_waited_in_vain(std::int64_t now) const;
  /// True if a detour of that length [m] is not worth taking before having waited.
  [[nodiscard]] bool is_long(double length) const;

  /// Drives, once, to the reachable place nearest to a goal that lies in an obstacle: seen at a slant, a smooth thing
  /// and nothing at all look alike to a sonar.
  [[nodiscard]] std::optional<PathOrder> look_again(RouteMap& map, const RouteRequest& request, const Route& route,
                                                    std::int64_t now);
  /// Makes way for somebody who comes out of the door before which the robot waits.
  [[nodiscard]] std::optional<PathOrder> make_way(RouteMap& map, const Pose2& world_from_robot, std::int64_t now);
  /// Turns the robot, where it stands and waits, towards what blocks its path: between two cones nothing is heard, and
  /// evidence there would outlive what stood in the way.
  [[nodiscard]] std::optional<PathOrder> face_blockage(const RouteMap& map, const Pose2& world_from_robot,
                                                       std::int64_t now);

  /// What the sonars have drawn round the blockage, as obstacles: evidence fades while the robot takes the long detour,
  /// and it would turn back half-way, again and again.
  [[nodiscard]] std::vector<SuspectedObstacle> evidence(const RouteMap& map) const;

  [[nodiscard]] bool is_look() const { return is_look_; }
  /// Why it waits, one sentence.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  void set_reason(const std::string& reason) { reason_ = reason; }

 private:
  /// The door before or in which the robot waits, if it has not waited beside one too often.
  [[nodiscard]] const Door* blocking_door(const RouteMap& map) const;
  /// How far [m] from the place to wait something stands on the blocked path; walls are nothing.
  [[nodiscard]] double distance_of_what_blocks(const RouteMap& map) const;
  [[nodiscard]] std::optional<PathOrder> wait_beside(RouteMap& map, const Door& door, const Polyline& path,
                                                     std::int64_t now);
  /// Sends the robot to another place to wait.
  void leave_for(const Eigen::Vector2d& place, std::int64_t now);
  [[nodiscard]] double seconds_waited(std::int64_t now) const;

  GoalParams params_;
  std::vector<Door> doors_;
  Blockage blockage_;
  std::string reason_;
  Polyline path_;                                    // that is blocked
  double reference_length_ = 0.0;                    // [m]
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero();  // [m] world, to wait at
  double blocker_distance_ = 0.0;                    // [m] from there to what blocked the path at first
  std::int64_t sent_ = 0;                            // [us] when the robot set off for the place
  std::int64_t since_ = 0;                           // [us] when it began to stand there; 0 = on its way
  std::int64_t last_facing_ = 0;                     // [us] when it was last told to turn towards what blocks
  bool is_look_ = false;                             // at a gap
  bool has_looked_again_ = false;
  int waits_beside_ = 0;  // a door, on the way to this stop
};

}  // namespace luminav
