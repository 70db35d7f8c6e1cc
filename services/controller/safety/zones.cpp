#include "services/controller/safety/zones.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kSpacing = 0.05;  // [m] between points of an edge: the margin before a wall is as wide

}  // namespace

Zones::Zones(const std::vector<Zone>& zones) {
  for (const Zone& zone : zones) {
    if (zone.kind == ZoneKind::kKeepOut) {
      keep_out_.push_back({zone, edge_points(zone.polygon, kSpacing)});
    } else {
      slow_.push_back(zone);
    }
  }
}

std::size_t Zones::add_edges(const Pose2& world_from_robot, double radius, std::vector<Eigen::Vector2d>& points) const {
  const Eigen::Vector2d robot = world_from_robot.position();
  const Pose2 robot_from_world = world_from_robot.inverse();
  const std::size_t before = points.size();
  for (const KeepOut& area : keep_out_) {
    if (contains(area.zone.polygon, robot)) {
      continue;
    }
    for (const Eigen::Vector2d& point : area.edge) {
      if ((point - robot).squaredNorm() <= radius * radius) {
        points.push_back(robot_from_world * point);
      }
    }
  }
  return points.size() - before;
}

std::string Zones::keep_out_at(const Pose2& world_from_robot) const {
  const auto inside = std::find_if(keep_out_.begin(), keep_out_.end(), [&](const KeepOut& area) {
    return contains(area.zone.polygon, world_from_robot.position());
  });
  return inside == keep_out_.end() ? "" : inside->zone.name;
}

const Zone* Zones::slow_at(const Pose2& world_from_robot, double ahead) const {
  constexpr double kStep = 0.1;  // [m]
  const int steps = static_cast<int>(std::ceil(std::abs(ahead) / kStep));
  const Zone* slowest = nullptr;
  for (const Zone& zone : slow_) {
    for (int i = 0; i <= steps; ++i) {
      const double along = steps == 0 ? 0.0 : ahead * i / steps;
      const bool is_there = contains(zone.polygon, world_from_robot * Eigen::Vector2d(along, 0.0));
      if (is_there && (slowest == nullptr || zone.speed < slowest->speed)) {
        slowest = &zone;
      }
    }
  }
  return slowest;
}

}  // namespace luminav
