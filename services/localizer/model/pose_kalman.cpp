#include "services/localizer/model/pose_kalman.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace luminav {

void predict(PoseBelief& belief, const Pose2& delta, const Eigen::Matrix3d& noise) {
  const double c = std::cos(belief.pose.theta);
  const double s = std::sin(belief.pose.theta);
  const double dx = c * delta.x - s * delta.y;
  const double dy = s * delta.x + c * delta.y;
  belief.pose = {belief.pose.x + dx, belief.pose.y + dy, wrap_angle(belief.pose.theta + delta.theta)};
  Eigen::Matrix3d by_pose;
  by_pose << 1.0, 0.0, -dy, 0.0, 1.0, dx, 0.0, 0.0, 1.0;
  Eigen::Matrix3d world_from_robot;
  world_from_robot << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d moved = by_pose * belief.covariance * by_pose.transpose();
  belief.covariance = moved + world_from_robot * noise * world_from_robot.transpose();
}

void fuse_pose(PoseBelief& belief, const Eigen::Vector3d& offset, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d sum = belief.covariance + covariance;
  const Eigen::Matrix3d gain = belief.covariance * sum.inverse();
  const Eigen::Vector3d step = gain * offset;
  belief.pose = {belief.pose.x + step.x(), belief.pose.y + step.y(), wrap_angle(belief.pose.theta + step.z())};
  // (I - K) P: a large variance of what was not measured comes in through the gain alone
  const Eigen::Matrix3d reduction = gain * belief.covariance;
  belief.covariance -= 0.5 * (reduction + reduction.transpose());
}

}  // namespace luminav
