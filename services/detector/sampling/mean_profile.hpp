#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/common/image/grey_image.hpp"

namespace luminav {

/// A line of the ceiling from which profiles run.
struct SideLine {
  Pose2 pose;             // robot_from_outline
  double height = 2.8;    // [m] above the floor
  Eigen::Vector2d along;  // direction of the line in the outline's frame
  Eigen::Vector2d out;    // in which the profiles run
};

/// Grey levels along profiles, their mean.
struct SideProfile {
  static constexpr double kStep = 0.004;  // [m] from one to the next, about a pixel
  static constexpr std::size_t kMaxSteps = 40;
  static constexpr int kMaxLines = 16;

  std::array<double, kMaxSteps> grey{};
  std::size_t steps = 0;
  int lines = 0;  // that are in view; 0: all grey levels are 0
};

/// Where the profiles begin.
struct ProfileLines {
  double first = 0.0;     // [m] outwards
  std::size_t steps = 0;  // at most kMaxSteps
  double from = 0.0;      // [m] along, of the first one
  double apart = 0.0;     // [m] from one to the next
  int count = 0;          // at most kMaxLines
};

/// Lines that are not in view all along are left out.
SideProfile mean_profile(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                         const ProfileLines& lines);

}  // namespace luminav
