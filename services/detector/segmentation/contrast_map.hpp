#pragma once

#include "services/detector/sampling/raster.hpp"

namespace luminav {

/// How far each cell of a reduced image sinks below its surroundings. These are what is left when everything narrower
/// than a window is filled up (closing top hat, Serra 1982), so shading, pools of light and daylight from a window drop
/// out. It is measured after the lamps were cut off, or every strip between a lamp and the image border would look
/// dark.
class ContrastMap {
 public:
  /// `radius` [cells of `image`]: half the window; things wider than 2 radius + 1 cells have no contrast.
  /// `ignore_lines`: dark lines thinner than 4 cells (the grid between tiles) do not count as surroundings.
  void compute(const Raster& image, int radius, bool ignore_lines);

  /// Of what is narrower than 2 radius + 1 cells only, below its rims, however bright these are (shadows in a
  /// negative). `is_noisy`: cells are too small to be taken as they are.
  void compute_narrow(const Raster& image, int radius, bool is_noisy);

  [[nodiscard]] const Raster& dark() const { return dark_; }
  /// The same without the outermost cell of whatever is dark, at every depth; the image border takes none.
  const Raster& eroded();
  /// Noise of one cell [grey]: median absolute difference of horizontal neighbours, as a standard deviation.
  [[nodiscard]] static double noise_of(const Raster& image);

 private:
  Raster dark_;
  Raster eroded_;
};

}  // namespace luminav
