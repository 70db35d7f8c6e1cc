#pragma once

#include <Eigen/Core>

#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

// Kalman filter of three states. No allocation.

/// Moves a belief by an odometry step; `noise` in the frame at the step's beginning.
void predict(PoseBelief& belief, const Pose2& delta, const Eigen::Matrix3d& noise);

/// Corrects by a measurement of the whole pose: `offset` is measurement - pose, heading wrapped, with the measurement's
/// covariance, both in the world frame. What is not measured has a large variance.
void fuse_pose(PoseBelief& belief, const Eigen::Vector3d& offset, const Eigen::Matrix3d& covariance);

}  // namespace luminav
