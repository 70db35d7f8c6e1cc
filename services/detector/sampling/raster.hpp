#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Grey image or mask of small size: a working copy of a camera image in which one cell stands for a square of pixels.
using Raster = cv::Mat1b;

/// The same pixels as OpenCV reads them; nobody may write to them.
Raster raster_of(const GreyView& image);
/// All cells of a raster that is no part of another.
inline std::span<const std::uint8_t> cells_of(const Raster& raster) {
  return {raster.data, raster.total()};
}
inline GreyView view_of(const Raster& raster) {
  return {raster.cols, raster.rows, cells_of(raster)};
}

/// Means of factor x factor squares, rounded, times `gain`, at most 255. Rows and columns that fill no square are left
/// out.
void reduce(const GreyView& image, int factor, Raster& result, int gain = 1);

/// Cells within `radius` of one in x and y, for OpenCV's morphology.
Raster square_of(int radius);

}  // namespace luminav
