#include "services/controller/controller_messages.hpp"

#include <algorithm>

#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxPathPoints = 20'000;
constexpr std::size_t kMaxAlternatives = 10'000;

}  // namespace

std::optional<FollowedPath> path_of(const path_t& message, std::string& why) {
  const auto count = static_cast<std::size_t>(std::max(0, message.count));
  if (count > kMaxPathPoints || message.x.size() < count || message.y.size() < count ||
      !all_finite({message.tolerance, message.theta, message.heading_tolerance})) {
    why = "PATH: impossible size or number";
    return std::nullopt;
  }
  FollowedPath path;
  path.goal_id = message.goal_id;
  path.pose_index = message.pose_index;
  path.sequence = message.sequence;
  path.tolerance = std::max(0.0, message.tolerance);
  path.has_theta = message.has_theta != 0;
  path.theta = wrap_angle(message.theta);
  path.heading_tolerance = std::max(0.0, message.heading_tolerance);
  for (std::size_t i = 0; i < count; ++i) {
    if (!all_finite({message.x[i], message.y[i]})) {
      why = "PATH: a point is not a number";
      return std::nullopt;
    }
    path.points.emplace_back(message.x[i], message.y[i]);
  }
  return path;
}

std::optional<std::vector<PoseAlternative>> alternatives_of(const hypotheses_t& message, const Pose2& odom_from_robot,
                                                            std::string& why) {
  const auto count = static_cast<std::size_t>(std::max(0, message.count));
  if (count > kMaxAlternatives || message.x.size() < count || message.y.size() < count ||
      message.theta.size() < count || message.weight.size() < count) {
    why = "HYPOTHESES: impossible size";
    return std::nullopt;
  }
  std::vector<PoseAlternative> alternatives;
  alternatives.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!all_finite({message.x[i], message.y[i], message.theta[i], message.weight[i]}) || message.weight[i] < 0.0F) {
      why = "HYPOTHESES: a pose or weight that cannot be";
      return std::nullopt;
    }
    const Pose2 world_from_robot{message.x[i], message.y[i], wrap_angle(message.theta[i])};
    alternatives.push_back({world_from_robot * odom_from_robot.inverse(), message.weight[i]});
  }
  return alternatives;
}

control_status_t status_of(const ControlOutput& output, const FollowedPath& path) {
  control_status_t status{};
  status.state = static_cast<std::int8_t>(output.state);
  status.reason = output.reason;
  status.goal_id = path.goal_id;
  status.path_sequence = path.sequence;
  if (output.follow.look_ahead) {
    status.has_look_ahead = true;
    status.look_ahead_x = output.follow.look_ahead->point.x();
    status.look_ahead_y = output.follow.look_ahead->point.y();
    status.distance_left = output.follow.look_ahead->distance_left;
  }
  status.attractive_x = output.follow.force.attractive.x();
  status.attractive_y = output.follow.force.attractive.y();
  status.repulsive_x = output.follow.force.repulsive.x();
  status.repulsive_y = output.follow.force.repulsive.y();
  status.clearance = output.clearance;
  status.linear = output.twist.linear;
  status.angular = output.twist.angular;
  status.seconds_without_progress = output.seconds_without_progress;
  return status;
}

}  // namespace luminav
