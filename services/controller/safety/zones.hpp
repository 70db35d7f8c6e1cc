#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// The rules of a building's zones for a robot whose pose is known, or may be one of several.
class Zones {
 public:
  explicit Zones(const std::vector<Zone>& zones);

  /// Adds the edges of all keep-out zones within `radius` [m] of the robot, in its frame, and returns how many points
  /// these are. A zone that the robot is inside has no edge: it may leave it.
  std::size_t add_edges(const Pose2& world_from_robot, double radius, std::vector<Eigen::Vector2d>& points) const;
  /// Name of the keep-out zone in which the robot is; "" = none.
  [[nodiscard]] std::string keep_out_at(const Pose2& world_from_robot) const;
  /// The slow zone with the least speed at the robot or up to `ahead` [m] before it (behind it, where negative), or
  /// nullptr.
  [[nodiscard]] const Zone* slow_at(const Pose2& world_from_robot, double ahead) const;

 private:
  struct KeepOut {
    Zone zone;
    std::vector<Eigen::Vector2d> edge;  // [m] world, 5 cm apart
  };
  std::vector<KeepOut> keep_out_;
  std::vector<Zone> slow_;
};

}  // namespace luminav
