#include "services/detector/segmentation/row_bits.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

/// Bit i of the result is the lowest bit of byte i: the multiplication moves all eight into the highest byte.
std::uint64_t gather_bits(std::uint64_t ones) {
  return (ones * 0x0102040810204080ULL) >> 56;
}

}  // namespace

LUMINAV_VECTOR_CLONES
void take_row_bits(const std::uint8_t* pixels, int width, int rows, int level, std::uint64_t* bits, std::size_t apart) {
  alignas(32) std::array<std::uint8_t, 64> ones;
  const auto floor = static_cast<std::uint8_t>(std::clamp(level, 0, 255));
  for (int y = 0; y < rows; ++y, pixels += width, bits += apart) {
    for (int x = 0; x < width; x += 64) {
      const int count = std::min(64, width - x);
      if (count == 64) {
#pragma GCC ivdep
        for (std::size_t i = 0; i < 64; ++i) {
          ones[i] = pixels[static_cast<std::size_t>(x) + i] > floor ? 1 : 0;
        }
      } else {
        ones.fill(0);
        for (int i = 0; i < count; ++i) {
          ones[static_cast<std::size_t>(i)] = pixels[x + i] > floor ? 1 : 0;
        }
      }
      std::uint64_t word = 0;
      for (std::size_t k = 0; k < 8; ++k) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, ones.data() + 8 * k, 8);
        word |= gather_bits(eight) << (8 * k);
      }
      bits[x / 64] = word;
    }
  }
}

}  // namespace luminav
