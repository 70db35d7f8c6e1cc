#pragma once

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// One moment of a run, kept for pictures.
struct TrailPoint {
  Pose2 truth;
  Pose2 believed;
  Pose2 odometry;
  int state = 0;      // pose_t::STATE_*
  int estimator = 0;  // pose_t::ESTIMATOR_*
  double time = 0.0;  // [s] since the first truth
};

}  // namespace luminav
