#include "services/planner/planner_messages.hpp"

#include "services/common/geometry/angle.hpp"

namespace luminav {

GoalRequest request_from(const goal_t& message) {
  GoalRequest request;
  request.id = message.id;
  for (const goal_pose_t& pose : message.poses) {
    request.stops.push_back({pose.place, {pose.x, pose.y, wrap_angle(pose.theta)}, pose.has_theta != 0, pose.wait});
  }
  request.loop = message.loop != 0;
  request.policy = static_cast<FailurePolicy>(message.policy);
  request.tolerance = message.tolerance;
  request.heading_tolerance = message.heading_tolerance;
  return request;
}

path_t path_message(const GoalPath& path, std::int64_t utime) {
  path_t message{};
  message.utime = utime;
  message.goal_id = path.goal_id;
  message.pose_index = path.stop_index;
  message.sequence = path.sequence;
  message.tolerance = path.tolerance;
  message.has_theta = path.has_theta;
  message.theta = path.theta;
  message.heading_tolerance = path.heading_tolerance;
  message.count = static_cast<std::int32_t>(path.points.size());
  for (const Eigen::Vector2d& point : path.points) {
    message.x.push_back(static_cast<float>(point.x()));
    message.y.push_back(static_cast<float>(point.y()));
  }
  return message;
}

navigation_status_t navigation_message(const NavigationReport& report, const GoalPath& path, std::int64_t utime) {
  navigation_status_t message{};
  message.utime = utime;
  message.goal_id = report.goal_id;
  message.pose_index = report.stop_index;
  message.pose_count = report.stop_count;
  message.state = static_cast<std::int8_t>(report.state);
  message.cause = report.cause;
  if (report.target) {
    message.has_target = 1;
    message.x = report.target->pose.x;
    message.y = report.target->pose.y;
    message.has_theta = report.target->has_theta;
    message.theta = report.target->pose.theta;
  }
  message.distance_left = report.distance_left;
  message.path_sequence = path.sequence;
  message.replans = report.replans;
  return message;
}

}  // namespace luminav
