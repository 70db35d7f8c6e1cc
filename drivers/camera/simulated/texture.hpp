#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace luminav::simulated {

/// Mineral-fibre ceiling tiles in their grid: reflectance of 2 x 2 tiles, repeated for ever.
class TileTexture {
 public:
  static constexpr int kSide = 512;             // [texels], a power of two
  static constexpr double kTile = 0.6;          // [m]
  static constexpr double kPeriod = 2 * kTile;  // [m]
  static constexpr float kWhite = 200.0F;       // texel value of reflectance 1

  /// `blur` [m] is the 1-sigma of the picture's own sharpness there: the texture holds what a camera can resolve.
  TileTexture(std::uint64_t seed, double blur);

  [[nodiscard]] const std::uint8_t* texels() const { return texels_.data(); }

 private:
  std::vector<std::uint8_t> texels_;  // row-major, [y][x]
};

}  // namespace luminav::simulated
