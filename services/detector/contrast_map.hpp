#pragma once

#include <cstdint>
#include <vector>

#include "services/detector/reduced_image.hpp"

namespace luminav {

/// How far each cell of a reduced image sinks below its surroundings. These are what is left when everything narrower
/// than a window is filled up (closing top hat, Serra 1982), so shading, pools of light and daylight from a window drop
/// out. It is measured after the lamps were cut off, or every strip between a lamp and the image border would look
/// dark.
class ContrastMap {
 public:
  /// `radius` [cells of `image`]: half the window; things wider than 2 radius + 1 cells have no contrast.
  /// `ignore_lines`: dark lines thinner than 4 cells (joints between tiles) do not count as surroundings.
  void compute(const Raster& image, int radius, bool ignore_lines);

  [[nodiscard]] const Raster& dark() const { return dark_; }
  /// The largest dark() of something broad.
  [[nodiscard]] int deepest() const { return deepest_; }
  /// The same within the window round each cell. Made where it is asked for.
  [[nodiscard]] const Raster& dark_peak();
  /// Noise of one cell of the reduced image [grey], from the median difference of neighbours.
  [[nodiscard]] double noise() const { return noise_; }

 private:
  Raster clean_;  // without lines
  Raster dilated_;
  Raster half_;  // half the size again: surroundings are smooth, so they may be computed coarsely
  Raster wide_;  // continued beyond the borders
  Raster eroded_;
  Raster wide_opened_;
  Raster capped_;
  Raster coarse_;  // half the size once more
  Raster coarse_mean_;
  Raster mean_;
  std::vector<std::uint32_t> sums_;
  std::vector<float> per_cell_;      // inverse areas of windows
  std::vector<std::uint8_t> steps_;  // between neighbours
  Raster filled_;
  Raster closed_;
  Raster peak_;
  Raster broad_;
  Raster scratch_;
  Raster closed_full_;
  Raster dark_;
  Raster dark_peak_;
  bool has_dark_peak_ = false;
  int deepest_ = 0;      // [grey]
  int half_radius_ = 1;  // of the window, in cells of half the size again
  double noise_ = 1.0;
};

}  // namespace luminav
