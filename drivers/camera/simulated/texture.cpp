#include "drivers/camera/simulated/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/camera/simulated/random.hpp"

namespace luminav::simulated {
namespace {

constexpr int kSide = TileTexture::kSide;
constexpr double kTexel = TileTexture::kPeriod / kSide;  // [m]
constexpr std::uint64_t kPurpose = 1;

// By eye after real pictures of such ceilings.
constexpr double kLineHalfWidth = 0.006;  // [m] the dark joint at the grid of T bars
constexpr double kLineReflectance = 0.74;
constexpr double kTileSpread = 0.02;  // 1-sigma of a tile's reflectance
constexpr double kSpeckle = 0.10;     // 1-sigma of one texel, before the camera's blur
constexpr double kPinholeShare = 0.01;
constexpr double kPinholeReflectance = 0.45;

/// Blurs along x on a ring; the caller turns the picture for y.
std::vector<double> blurred_along_x(const std::vector<double>& picture, double sigma_texels) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3.0 * sigma_texels)));
  std::vector<double> kernel;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(std::exp(-0.5 * (i / sigma_texels) * (i / sigma_texels)));
    sum += kernel.back();
  }
  std::vector<double> result(picture.size());
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      double value = 0.0;
      for (int i = -reach; i <= reach; ++i) {
        value += kernel[static_cast<std::size_t>(i + reach)] *
                 picture[static_cast<std::size_t>(y * kSide + ((x + i) & (kSide - 1)))];
      }
      result[static_cast<std::size_t>(y * kSide + x)] = value / sum;
    }
  }
  return result;
}

std::vector<double> turned(const std::vector<double>& picture) {
  std::vector<double> result(picture.size());
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      result[static_cast<std::size_t>(x * kSide + y)] = picture[static_cast<std::size_t>(y * kSide + x)];
    }
  }
  return result;
}

/// [m] to the nearest line of the grid.
double distance_to_line(int texel) {
  const double position = (texel + 0.5) * kTexel;
  return std::abs(position - TileTexture::kTile * std::round(position / TileTexture::kTile));
}

}  // namespace

TileTexture::TileTexture(std::uint64_t seed, double blur) {
  SplitMix random = random_stream(seed, kPurpose, 0);
  std::array<double, 4> tile{};
  for (double& reflectance : tile) {
    reflectance = 1.0 + kTileSpread * random.gauss();
  }
  std::vector<double> picture;
  picture.reserve(static_cast<std::size_t>(kSide) * kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      double reflectance = tile[static_cast<std::size_t>(2 * (y / (kSide / 2)) + x / (kSide / 2))];
      reflectance += kSpeckle * random.gauss();
      if (random.uniform() < kPinholeShare) {
        reflectance = kPinholeReflectance;
      }
      if (std::min(distance_to_line(x), distance_to_line(y)) < kLineHalfWidth) {
        reflectance = kLineReflectance;
      }
      picture.push_back(reflectance);
    }
  }
  const double sigma_texels = std::max(0.3, blur / kTexel);
  picture = turned(blurred_along_x(turned(blurred_along_x(picture, sigma_texels)), sigma_texels));
  texels_.reserve(picture.size());
  for (const double reflectance : picture) {
    texels_.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(reflectance * kWhite, 0.0, 255.0))));
  }
}

}  // namespace luminav::simulated
