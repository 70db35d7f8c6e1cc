#include "services/planner/goals/goal_sentences.hpp"

#include <fmt/format.h>

#include <cmath>

namespace luminav {

std::string place_of(const GoalStop& stop) {
  return stop.place.empty() ? fmt::format("({:.1f}, {:.1f})", stop.pose.x, stop.pose.y)
                            : fmt::format("{} ({:.1f}, {:.1f})", stop.place, stop.pose.x, stop.pose.y);
}

std::string no_path_sentence(const Route& route, const GridGeometry& geometry, const GoalStop& stop, double tolerance) {
  const Eigen::Vector2d goal = stop.pose.position();
  const std::string nearest =
      route.nearest_reachable
          ? fmt::format("nearest reachable point ({:.1f}, {:.1f}) is {:.2f} m away, tolerance {:.2f} m",
                        route.nearest_reachable->x(), route.nearest_reachable->y(),
                        (*route.nearest_reachable - goal).norm(), tolerance)
          : "nothing is reachable from here";
  switch (route.outcome) {
    case RouteOutcome::kGoalOutside:
      return fmt::format("goal {} lies outside the map, which is {:.1f} to {:.1f} by {:.1f} to {:.1f} m",
                         place_of(stop), geometry.origin.x(),
                         geometry.origin.x() + geometry.columns * geometry.resolution, geometry.origin.y(),
                         geometry.origin.y() + geometry.rows * geometry.resolution);
    case RouteOutcome::kStartOutside:
      return "the robot stands outside the map";
    case RouteOutcome::kStartEnclosed:
      return fmt::format("the robot's own place is enclosed: no way leads out of it to {}", place_of(stop));
    case RouteOutcome::kGoalBlocked:
      return fmt::format("goal {} lies in or beside an obstacle: {}", place_of(stop), nearest);
    default:
      return fmt::format("no way leads to {}: {}", place_of(stop), nearest);
  }
}

std::string missed_sentence(const Pose2& world_from_robot, const GoalStop& stop, double tolerance) {
  const double turn = degrees(std::abs(wrap_angle(world_from_robot.theta - stop.pose.theta)));
  return fmt::format("stopped {:.2f} m from {}, tolerance {:.2f} m{}", distance(world_from_robot, stop.pose),
                     place_of(stop), tolerance,
                     stop.has_theta ? fmt::format(", heading {:.0f} degrees off", turn) : "");
}

std::string what_controller_says(const Situation& situation) {
  return !situation.control                  ? "the controller is silent"
         : situation.control->reason.empty() ? "the controller does not say why"
                                             : situation.control->reason;
}

}  // namespace luminav
