#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Grey image or mask of small size: a working copy of a camera image in which one cell stands for a square of pixels.
struct Raster {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> cells;

  void resize(int columns, int rows) {
    width = columns;
    height = rows;
    cells.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  }
  [[nodiscard]] const std::uint8_t* row(int y) const {
    return cells.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
  [[nodiscard]] std::uint8_t* row(int y) {
    return cells.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  }
};

/// 255 less each grey level.
void negate(std::span<const std::uint8_t> grey, std::vector<std::uint8_t>& result);

/// Means of factor x factor squares, rounded, times `gain`, at most 255; factor 1, 2 or 4. Rows and columns that fill
/// no square are left out.
void reduce(const GreyView& image, int factor, Raster& result, int gain = 1);

/// How many are brighter.
int cells_above(const Raster& image, int level);
/// The largest cell; 0 of none.
int max_cell(const Raster& image);

/// Largest (smallest) cell within `radius` cells in x and y; beyond the border there is nothing.
void dilate(const Raster& image, int radius, Raster& result, Raster& scratch);
void erode(const Raster& image, int radius, Raster& result, Raster& scratch);
/// The same where all of that lies within the image, whose cells are lost: the result is smaller by `radius` on every
/// side.
void dilate_within(Raster& image, int radius, Raster& result);
void erode_within(Raster& image, int radius, Raster& result);

}  // namespace luminav
