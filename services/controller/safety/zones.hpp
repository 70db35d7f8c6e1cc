#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav {

/// The rules of a building's zones for a robot whose pose is known, or may be one of several.
class Zones {
 public:
  /// `outline` [m]: the robot's, in its own frame.
  Zones(const std::vector<Zone>& zones, Polygon outline);

  /// Adds the edges of all keep-out zones within `radius` [m] of the robot, in its frame, and returns how many points
  /// these are. A zone that the outline reaches into has no edge: the robot may leave it, see `no_deeper`.
  std::size_t add_edges(const Pose2& world_from_robot, double radius, std::vector<Eigen::Vector2d>& points) const;
  /// What of a twist leads no deeper into a keep-out zone that the outline reaches into, or out of it: all of it, its
  /// straight or its turning part, or nothing. A robot whose middle is inside may go anywhere: the shortest way out may
  /// lead round a pillar.
  [[nodiscard]] DriveTwist no_deeper(const Pose2& world_from_robot, const DriveTwist& twist) const;
  /// Name of the keep-out zone in which the robot is; "" = none.
  [[nodiscard]] std::string keep_out_at(const Pose2& world_from_robot) const;
  /// True if a straight piece [m, world] keeps `distance` [m] from all keep-out zones.
  [[nodiscard]] bool is_line_free(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double distance) const;
  /// Notes where the robot [m, world] is: how far it has come along the one-way zones that it is in.
  void note_progress(const Eigen::Vector2d& robot);
  /// A one-way zone, and how far [m] the robot may still drive against it.
  struct LaneRoom {
    const Zone* zone = nullptr;
    double distance = 0.0;
  };
  /// The one-way zone against which the robot would drive, forwards or (where negative) backwards, in it or within a
  /// metre; nothing where there is none. It has 6 cm back from the edge and from as far as it came, inside no steeper
  /// than 30 degrees.
  [[nodiscard]] std::optional<LaneRoom> room_against(const Pose2& world_from_robot, double linear) const;
  /// Direction [rad, world] of the one-way zone in which the robot [m, world] is.
  [[nodiscard]] std::optional<double> lane_at(const Eigen::Vector2d& robot) const;
  /// The quiet zone in which the robot is, or nullptr.
  [[nodiscard]] const Zone* quiet_at(const Pose2& world_from_robot) const;
  /// The slow zone with the least speed at the robot or up to `ahead` [m] before it (behind it, where negative), or
  /// nullptr.
  [[nodiscard]] const Zone* slow_at(const Pose2& world_from_robot, double ahead) const;

 private:
  struct KeepOut {
    Zone zone;
    std::vector<Eigen::Vector2d> edge;  // [m] world, 5 cm apart
  };
  struct Lane {
    Zone zone;
    std::optional<double> farthest;  // [m] along its direction, since the robot came in
  };
  [[nodiscard]] double depth_inside(const Zone& zone, const Pose2& world_from_robot) const;
  /// The same, but 0 for a robot whose middle is inside.
  [[nodiscard]] double depth_of_edge(const Zone& zone, const Pose2& world_from_robot) const;

  Polygon outline_;
  double reach_ = 0.0;  // [m] from the middle of the robot to its farthest corner
  std::vector<KeepOut> keep_out_;
  std::vector<Lane> lanes_;
  std::vector<Zone> others_;
};

}  // namespace luminav
