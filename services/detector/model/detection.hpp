#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

enum class DetectionState { kUnknown, kLit, kUnlit, kHalf };

/// One fixture seen in an image.
struct Detection {
  FixtureShape shape = FixtureShape::kRectangle;
  DetectionState state = DetectionState::kUnknown;
  bool has_theta = true;                                     // false: round
  Pose2 robot_from_fixture;                                  // centre below the ceiling; x along the long side
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // [m^2, m rad, rad^2] x, y, theta in the robot frame;
                                                             // pixel noise and bloom only, no mounting errors
  double length = 0.0;                                       // [m] long side as seen; when cut, its visible part
  double width = 0.0;                                        // [m] short side as seen
  std::optional<double> scale;   // seen length / the kind's, bloom taken off; of a bar that is whole in view
  bool clipped = false;          // the image border cuts it
  bool near_end_visible = true;  // end of the long side towards -x of the fixture
  bool far_end_visible = true;   // end towards +x
  double fit = 0.0;              // 0..1 share of the outline that shows an edge
  std::array<Eigen::Vector2d, 4> corners_px{};          // of what is seen, going round
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();  // of robot_from_fixture
};

}  // namespace luminav
