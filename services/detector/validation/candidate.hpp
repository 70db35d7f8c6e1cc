#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/hypotheses/outline_proposer.hpp"
#include "services/detector/outline/outline_fit.hpp"
#include "services/detector/sampling/raster.hpp"

namespace luminav {

/// One image and what was computed of it.
struct CeilingFrame {
  const GreyView& image;
  const Raster& reduced;
  const Raster& dark;        // depth below the surroundings, in the reduced image
  int factor = 4;            // [px] side of a cell of the reduced image
  double pixel_noise = 4.0;  // [grey]
  int brightest = 255;       // [grey] of the cells
  double saturated = 0.0;    // share of the cells
  int gain = 1;              // by which `reduced` is brighter than the image
  bool is_negative = false;  // of a picture in which bare battens are looked for, and so are its cells
};

/// Grey level of the cell that a pixel of the image belongs to.
inline int cell_at(const Raster& cells, const Eigen::Vector2d& pixel, int factor) {
  const int column = std::clamp(static_cast<int>((pixel.x() + 0.5) / factor), 0, cells.cols - 1);
  const int row = std::clamp(static_cast<int>((pixel.y() + 0.5) / factor), 0, cells.rows - 1);
  return cells(row, column);
}

/// A guess of what a region shows, and where it lies: by its edges, or by the region's own rectangle.
struct Candidate {
  OutlineHypothesis hypothesis;
  OutlineFit fit;
  int level = 0;  // [grey] above which the region was cut out; of an unlit one, its depth
  bool bright = true;
  bool by_edges = true;
  double score = 0.0;  // the best one wins where several claim a place

  /// All of it is in view, and seen.
  [[nodiscard]] bool is_whole() const {
    const bool bar = hypothesis.outline.shape == FixtureShape::kRectangle;
    return !by_edges || (bar ? fit.ends_visible() == 2 : hypothesis.is_whole);
  }
  /// Nothing better is to be expected of what it covers.
  [[nodiscard]] bool is_certain() const {
    constexpr double kCertain = 0.9;  // share of the outline that shows an edge
    return by_edges && is_whole() && hypothesis.burning == 0 && fit.quality() > kCertain;
  }
};

/// Grey level, or depth, at a place of the outline; nothing out of view.
inline std::optional<int> level_at(const CeilingFrame& frame, const CeilingCamera& camera, const Candidate& candidate,
                                   const PointTransform& pose, const Eigen::Vector2d& place) {
  const auto pixel = camera.pixel_of_ceiling_point(pose * place, candidate.hypothesis.outline.height);
  if (!pixel || !camera.is_in_image(*pixel)) {
    return std::nullopt;
  }
  return cell_at(candidate.bright ? frame.reduced : frame.dark, *pixel, frame.factor);
}

}  // namespace luminav
