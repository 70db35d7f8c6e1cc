#include "drivers/camera/sources/pixel_formats.hpp"

#include <algorithm>

namespace luminav {
namespace {

/// Every `step`-th byte of each row.
bool pick(std::span<const std::uint8_t> bytes, int stride, int step, GreyImage& image) {
  const auto width = static_cast<std::size_t>(std::max(0, image.width));
  const auto height = static_cast<std::size_t>(std::max(0, image.height));
  const auto pitch = static_cast<std::size_t>(std::max(0, stride));
  const auto bytes_per_row = width * static_cast<std::size_t>(step);
  if (height == 0 || pitch < bytes_per_row || bytes.size() < (height - 1) * pitch + bytes_per_row) {
    return false;
  }
  image.pixels.resize(width * height);
  for (std::size_t row = 0; row < height; ++row) {
    const std::uint8_t* in = bytes.data() + row * pitch;
    std::uint8_t* out = image.pixels.data() + row * width;
    for (std::size_t column = 0; column < width; ++column) {
      out[column] = in[column * static_cast<std::size_t>(step)];
    }
  }
  return true;
}

}  // namespace

bool luma_from_yuyv(std::span<const std::uint8_t> bytes, int stride, GreyImage& image) {
  return pick(bytes, stride, 2, image);
}

bool luma_from_grey(std::span<const std::uint8_t> bytes, int stride, GreyImage& image) {
  return pick(bytes, stride, 1, image);
}

}  // namespace luminav
