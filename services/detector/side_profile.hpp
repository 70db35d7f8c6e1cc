#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/common/image/grey_image.hpp"

namespace luminav {

/// One side of an outline: the line along which the ceiling is looked at.
struct SideLine {
  Pose2 pose;              // robot_from_outline
  double height = 2.8;     // [m] above the floor
  Eigen::Vector2d along;   // direction of the side in the outline's frame
  Eigen::Vector2d out;     // its normal, outwards
  double half_length = 0;  // [m] of the side
  double distance = 0;     // [m] of the side from the outline's middle
};

/// Mean grey levels across a side, over lines that run outwards.
struct SideProfile {
  static constexpr double kStep = 0.004;  // [m] from one to the next, about a pixel
  static constexpr std::size_t kMostSteps = 40;
  static constexpr int kMostLines = 144;

  std::array<double, kMostSteps> grey{};
  std::size_t steps = 0;
  int lines = 0;  // that are in view; 0: all grey levels are 0
};

/// Where the lines of a profile begin.
struct ProfileLines {
  double first = 0.0;                // [m] outwards of the side
  std::size_t steps = 0;             // at most kMostSteps
  double from = 0.0;                 // [m] along the side from its middle, of the first line
  double apart = 0.0;                // [m] from one line to the next, along the side
  int count = 0;                     // at most kMostLines
  double step = SideProfile::kStep;  // [m] from one grey level to the next
};

/// Lines that are not in view all along are left out.
SideProfile mean_profile(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                         const ProfileLines& lines);

}  // namespace luminav
