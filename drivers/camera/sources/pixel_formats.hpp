#pragma once

#include <cstdint>
#include <span>

#include "services/common/image/grey_image.hpp"

namespace luminav {

// Luma of what webcams deliver, into `image`, whose size says how large the picture is. `stride` [bytes] is from row
// to row. False, and nothing written, when there are fewer bytes than that takes.

/// YUYV (YUY2), two bytes a pixel: luma first.
[[nodiscard]] bool luma_from_yuyv(std::span<const std::uint8_t> bytes, int stride, GreyImage& image);

/// GREY, one byte a pixel.
[[nodiscard]] bool luma_from_grey(std::span<const std::uint8_t> bytes, int stride, GreyImage& image);

}  // namespace luminav
