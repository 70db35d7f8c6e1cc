#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "services/common/image/grey_image.hpp"

namespace luminav {

/// Grey level between pixels; only where `is_sampled`.
inline float bilinear(const GreyView& image, float x, float y) {
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column);
  const float fy = y - static_cast<float>(row);
  const std::uint8_t* p = image.pixels.data() + static_cast<std::ptrdiff_t>(row) * image.width + column;
  const std::uint8_t* q = p + image.width;
  const float top = static_cast<float>(p[0]) + fx * static_cast<float>(p[1] - p[0]);
  const float bottom = static_cast<float>(q[0]) + fx * static_cast<float>(q[1] - q[0]);
  return top + fy * (bottom - top);
}

/// True where bilinear may be asked, with a pixel to spare.
inline bool is_sampled(const GreyView& image, const Eigen::Vector2d& pixel) {
  return pixel.x() >= 1.0 && pixel.y() >= 1.0 && pixel.x() < image.width - 2.0 && pixel.y() < image.height - 2.0;
}

}  // namespace luminav
