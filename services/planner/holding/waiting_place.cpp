#include "services/planner/holding/waiting_place.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kInTheWay =
    0.7;                          // [m] from the middle of the path: a person's radius, a tenth, half the robot's width
constexpr double kBefore = 1.5;   // [m] from the opening: farther away there is room to pass each other
constexpr double kOpening = 0.3;  // [m] before and behind the opening: nearer than to a shut leaf
constexpr double kMinAside = 0.9;  // [m] from the middle of the path: a tenth more on either side,
constexpr double kMaxAside = 1.5;  // [m] where the door still is in sight
constexpr double kMinDepth = 0.5;  // [m] before the opening, so that the robot sees into it
constexpr double kMaxDepth = 1.2;  // [m]
constexpr double kStep = 0.1;      // [m] between the places that are tried
constexpr double kRoom = 0.4;      // [m] to whatever is near: its corners are 0.33 m from its middle when it turns

}  // namespace

bool is_in_opening(const Door& door, const Eigen::Vector2d& place) {
  const Eigen::Vector2d in_door = door.world_from_door.inverse() * place;
  return std::abs(in_door.x()) < 0.5 * door.width && std::abs(in_door.y()) < kOpening;
}

bool is_in_doorway(const Door& door, const Eigen::Vector2d& place) {
  const Eigen::Vector2d in_door = door.world_from_door.inverse() * place;
  return std::abs(in_door.x()) < kInTheWay && std::abs(in_door.y()) < kBefore;
}

std::vector<Eigen::Vector2d> places_beside(const Door& door, const Polyline& path, const ConfigurationSpace& space) {
  const Pose2 door_from_world = door.world_from_door.inverse();
  const Eigen::Vector2d start = door_from_world * path.front();
  const double coming_from =
      std::abs(start.y()) > kOpening ? start.y() : start.y() - (door_from_world * path.back()).y();
  const double side = coming_from > 0.0 ? 1.0 : -1.0;
  std::vector<Eigen::Vector2d> places;
  for (double beside = kMinAside; beside <= kMaxAside; beside += kStep) {
    for (double depth = kMinDepth; depth <= kMaxDepth; depth += kStep) {
      for (const double sign : {1.0, -1.0}) {
        const Eigen::Vector2d place = door.world_from_door * Eigen::Vector2d(sign * beside, side * depth);
        const Cell cell = space.geometry().cell_at(place);
        if (!space.is_blocked(cell) && space.clearance(cell) >= kRoom) {
          places.push_back(place);
        }
      }
    }
  }
  std::stable_sort(places.begin(), places.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - path.front()).norm() < (b - path.front()).norm();
  });
  return places;
}

}  // namespace luminav
