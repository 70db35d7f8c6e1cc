#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Grey level between pixels, each taken for what `level` makes of it.
template <typename Level>
inline float bilinear_of(const GreyView& image, float x, float y, Level level) {
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column);
  const float fy = y - static_cast<float>(row);
  const std::uint8_t* p = image.pixels.data() + static_cast<std::ptrdiff_t>(row) * image.width + column;
  const std::uint8_t* q = p + image.width;
  const float top = level(p[0]) + fx * (level(p[1]) - level(p[0]));
  const float bottom = level(q[0]) + fx * (level(q[1]) - level(q[0]));
  return top + fy * (bottom - top);
}

/// Grey level between pixels; only where `is_sampled`.
inline float bilinear(const GreyView& image, float x, float y) {
  return bilinear_of(image, x, y, [](std::uint8_t pixel) { return static_cast<float>(pixel); });
}

/// The same of pixels that are cut off at `limit` first.
inline float bilinear_below(const GreyView& image, float x, float y, float limit) {
  return bilinear_of(image, x, y, [limit](std::uint8_t pixel) { return std::min(static_cast<float>(pixel), limit); });
}

/// True where bilinear may be asked, with a pixel to spare.
inline bool is_sampled(const GreyView& image, const Eigen::Vector2d& pixel) {
  return pixel.x() >= 1.0 && pixel.y() >= 1.0 && pixel.x() < image.width - 2.0 && pixel.y() < image.height - 2.0;
}

/// Grey levels at many places, with the same results to the last bit; `count` is a multiple of 8.
void bilinear_at(const GreyView& image, const float* x, const float* y, std::size_t count, float* grey);

/// The same of pixels that are cut off at a limit of each place first.
void bilinear_below_at(const GreyView& image, const float* x, const float* y, const float* limit, std::size_t count,
                       float* grey);

}  // namespace luminav
