#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "services/common/image/grey_image.hpp"
#include "services/detector/outline_fit.hpp"
#include "services/detector/reduced_image.hpp"
#include "services/detector/region_outline.hpp"

namespace luminav {

inline constexpr double kElementFrame = 0.045;  // [m] a vent's frame is as bright as the ceiling: its slats end inside

/// One image and what was computed of it.
struct CeilingFrame {
  const GreyView& image;
  const Raster& reduced;
  const Raster& dark;        // depth below the surroundings, in the reduced image
  int factor = 4;            // [px] side of a cell of the reduced image
  double pixel_noise = 4.0;  // [grey]
};

/// Grey level of the cell that a pixel of the image belongs to.
inline int cell_at(const Raster& cells, const Eigen::Vector2d& pixel, int factor) {
  const int column = std::clamp(static_cast<int>((pixel.x() + 0.5) / factor), 0, cells.width - 1);
  const int row = std::clamp(static_cast<int>((pixel.y() + 0.5) / factor), 0, cells.height - 1);
  return cells.row(row)[column];
}

/// A narrower kind of fixture that a piece may as well be of which the border hides one long side.
struct NarrowerReading {
  double width = 0.0;  // [m]
  double share = 0.0;  // 0..1 how likely it is, by how many of the kinds the building has
};

/// A guess of what a region shows, moved onto the image's edges.
struct Candidate {
  OutlineHypothesis hypothesis;
  OutlineFit fit;
  double score = 0.0;
  std::optional<NarrowerReading> narrower{};
};

}  // namespace luminav
