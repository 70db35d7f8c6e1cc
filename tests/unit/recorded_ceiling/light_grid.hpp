#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav::testing {

/// A regular grid in which bars hang, fitted to where they were found.
struct LightGrid {
  Eigen::Vector2d pitch = Eigen::Vector2d::Zero();  // [m] across the bars, and along them
  double angle = 0.0;                               // [rad] from the rows across the bars to the rows along them
  double turn = 0.0;                                // [rad] of the bars from the rows along them, mean
  double spread = 0.0;                              // [m] RMS of the bars around the grid
  double turn_spread = 0.0;                         // [rad] RMS of the bars' headings around their mean
  std::size_t crossings = 0;                        // of the rows, where at least one hangs
};

/// Least squares over all bars, each at the crossing that is nearest by the spacing of neighbours: pitches and angles
/// are free. Throws std::runtime_error when no two hang beside each other, or none behind another.
LightGrid fit_light_grid(const std::vector<Pose2>& bars);

}  // namespace luminav::testing
