#include "services/planner/goals/issued_path.hpp"

#include "services/planner/goals/path_progress.hpp"

namespace luminav {
namespace {

constexpr double kWaitTolerance = 0.3;  // [m] for getting to a place to wait

}  // namespace

PathOrder path_to_stop(const Polyline& points, const GoalStop& stop) {
  PathOrder order;
  order.points = points;
  if (stop.has_theta) {
    order.theta = stop.pose.theta;
  }
  return order;
}

PathOrder path_to_wait(const Polyline& points, double theta) {
  return {points, kWaitTolerance, theta};
}

void IssuedPath::issue(const PathOrder& order, const StopList& stops, std::int64_t now) {
  if (order.points.empty() && stands_still(stops)) {
    return;
  }
  if (path_.sequence == 0) {
    // a restarted planner must not count below its predecessor
    path_.sequence = static_cast<int>(now / 1'000'000 % 1'000'000'000);
  }
  ++path_.sequence;
  path_.goal_id = stops.goal().id;
  path_.stop_index = stops.index();
  path_.points = order.points;
  path_.tolerance = order.tolerance > 0.0 ? order.tolerance : stops.tolerance();
  path_.has_theta = order.theta.has_value();
  path_.theta = order.theta.value_or(stops.stop().pose.theta);
  path_.heading_tolerance = order.heading_tolerance > 0.0 ? order.heading_tolerance : stops.heading_tolerance();
  at_ = 0;
}

void IssuedPath::stand_still(const StopList& stops, std::int64_t now) {
  if (!stands_still(stops)) {
    issue(path_to_stop({}, stops.stop()), stops, now);
  }
}

void IssuedPath::rename(std::int64_t goal_id) {
  path_.goal_id = goal_id;
  ++path_.sequence;
}

bool IssuedPath::stands_still(const StopList& stops) const {
  return path_.points.empty() && path_.goal_id == stops.goal().id;
}

void IssuedPath::advance(const Eigen::Vector2d& robot) {
  if (!path_.points.empty()) {
    at_ = nearest_ahead(path_.points, at_, robot);
  }
}

Polyline IssuedPath::remaining(const Eigen::Vector2d& robot) const {
  return rest_of(path_.points, at_, robot);
}

double IssuedPath::distance_to(const Eigen::Vector2d& robot) const {
  return (path_.points[at_] - robot).norm();
}

std::optional<Eigen::Vector2d> IssuedPath::point_ahead(const Eigen::Vector2d& robot, double distance) const {
  for (std::size_t i = at_; i < path_.points.size(); ++i) {
    if ((path_.points[i] - robot).norm() >= distance) {
      return path_.points[i];
    }
  }
  return std::nullopt;
}

bool IssuedPath::is_finished(const Situation& situation) const {
  return situation.control && situation.control->at_goal && situation.control->path_sequence == path_.sequence;
}

}  // namespace luminav
