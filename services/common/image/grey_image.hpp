#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace luminav {

/// Grey picture that somebody else owns; rows follow each other without gaps, from the top left pixel.
struct GreyView {
  int width = 0;   // [px]
  int height = 0;  // [px]
  std::span<const std::uint8_t> pixels;
};

/// 8-bit grey picture; rows follow each other without gaps, from the top left pixel.
struct GreyImage {
  int width = 0;   // [px]
  int height = 0;  // [px]
  std::vector<std::uint8_t> pixels;

  [[nodiscard]] GreyView view() const { return {width, height, pixels}; }
};

}  // namespace luminav
