#include "services/localizer/model/pose_kalman.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace luminav {

void predict(PoseBelief& belief, const Pose2& delta, const Eigen::Matrix3d& noise) {
  const double c = std::cos(belief.pose.theta);
  const double s = std::sin(belief.pose.theta);
  const Eigen::Vector3d by_heading(-s * delta.x - c * delta.y, c * delta.x - s * delta.y, 0.0);  // d(pose) / d(theta)
  belief.pose = {belief.pose.x + by_heading.y(), belief.pose.y - by_heading.x(),
                 wrap_angle(belief.pose.theta + delta.theta)};
  Eigen::Matrix3d rotation;
  rotation << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  // F P F' with F = I + by_heading e3'
  Eigen::Matrix3d& p = belief.covariance;
  p += by_heading * p.row(2).eval();
  p += p.col(2).eval() * by_heading.transpose();
  p += rotation * noise * rotation.transpose();
}

void fuse_pose(PoseBelief& belief, const Eigen::Vector3d& offset, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d gain = belief.covariance * Eigen::Matrix3d(belief.covariance + covariance).inverse();
  const Eigen::Vector3d step = gain * offset;
  belief.pose = {belief.pose.x + step.x(), belief.pose.y + step.y(), wrap_angle(belief.pose.theta + step.z())};
  // (I - K) P: a large variance of what was not measured comes in through the gain alone
  const Eigen::Matrix3d corrected = belief.covariance - gain * belief.covariance;
  belief.covariance = 0.5 * (corrected + corrected.transpose());
}

}  // namespace luminav
