#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace luminav {

/// What a detector saw on its way, for the debug picture; all in pixels.
struct DetectorTrace {
  std::vector<std::vector<Eigen::Vector2d>> contours;      // of every region that was looked at
  std::vector<std::array<Eigen::Vector2d, 4>> rectangles;  // that were tried ...
  std::vector<std::string> verdicts;                       // ... and what became of each
  void clear() {
    contours.clear();
    rectangles.clear();
    verdicts.clear();
  }
};

}  // namespace luminav
