#include "services/detector/profile_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

constexpr std::size_t kLanes = ProfileLanes::kLanes;
constexpr int kLength = 27;

GreyImage textured() {
  GreyImage image{64, 48, {}};
  for (int i = 0; i < 64 * 48; ++i) {
    image.pixels.push_back(static_cast<std::uint8_t>((i * 2654435761U) >> 21));
  }
  return image;
}

/// Lines through the whole image, up to its corners; the last of them leaves the view early.
ProfileLanes::Lines lines_through(const GreyImage& image) {
  ProfileLanes::Lines lines{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto share = static_cast<float>(lane) / (kLanes - 1);
    lines.x[lane] = share * (static_cast<float>(image.width) - 1.01F);
    lines.dx[lane] = (0.5F - share) * 2.0F;
    lines.y[lane] = lane % 2 == 0 ? 0.0F : static_cast<float>(image.height) - 1.01F;
    lines.dy[lane] = lane % 2 == 0 ? 0.97F : -0.97F;
    lines.last[lane] = kLength - 1;
  }
  lines.last.back() = 9;
  return lines;
}

TEST(ProfileLanes, AddsWhatOnePixelAfterTheOtherHasToTheLastBit) {
  const GreyImage image = textured();
  const ProfileLanes::Lines lines = lines_through(image);
  ProfileLanes lanes;
  lanes.clear(kLength);
  lanes.add(image.view(), lines);
  lanes.add(image.view(), lines);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    std::array<float, ProfileLanes::kLongest> profile{};
    lanes.copy_lane(lane, profile.data());
    float x = lines.x[lane];
    float y = lines.y[lane];
    for (int k = 0; k < kLength; ++k) {
      const float grey = bilinear(image.view(), x, y);
      EXPECT_EQ(profile[static_cast<std::size_t>(k)], grey + grey) << lane << " " << k;
      if (k < lines.last[lane]) {
        x += lines.dx[lane];
        y += lines.dy[lane];
      }
    }
  }
}

TEST(ProfileLanes, FindsTheLargestStepNearestToTheMiddle) {
  GreyImage image{64, 48, {}};
  for (int i = 0; i < 64 * 48; ++i) {
    const int x = i % 64;
    image.pixels.push_back(x < 20 ? 200 : x < 28 ? 100 : x < 30 ? 90 : 10);
  }
  ProfileLanes::Lines lines{};
  lines.x.fill(10.0F);
  lines.y.fill(5.0F);
  lines.dx.fill(1.0F);
  lines.last.fill(kLength - 1);
  lines.last[3] = 5;  // sees no step
  ProfileLanes lanes;
  lanes.clear(kLength);
  lanes.add(image.view(), lines);
  const ProfileLanes::Steps steps = lanes.largest_steps(2, 1.0F);
  EXPECT_EQ(steps.at[0], 10);  // of 100, nearer to the middle than the one of 90 behind it
  EXPECT_EQ(steps.height[0], 100.0F);
  EXPECT_EQ(steps.before[0], 50.0F);
  EXPECT_EQ(steps.behind[0], 50.0F);
  EXPECT_EQ(steps.at[3], -1);
}

TEST(PixelSampling, CutsPixelsOffBeforeItLooksBetweenThem) {
  const GreyImage image = textured();
  constexpr std::size_t kPlaces = 16;
  std::array<float, kPlaces> x{};
  std::array<float, kPlaces> y{};
  std::array<float, kPlaces> limit{};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    x[i] = 1.0F + 3.7F * static_cast<float>(i);
    y[i] = 45.9F - 2.9F * static_cast<float>(i);
    limit[i] = i % 2 == 0 ? 300.0F : 60.3F + static_cast<float>(i);
  }
  std::array<float, kPlaces> grey{};
  bilinear_below_at(image.view(), x.data(), y.data(), limit.data(), kPlaces, grey.data());
  for (std::size_t i = 0; i < kPlaces; ++i) {
    GreyImage cut = image;
    for (std::uint8_t& pixel : cut.pixels) {
      pixel = std::min(pixel, static_cast<std::uint8_t>(std::min(limit[i], 255.0F)));
    }
    EXPECT_EQ(grey[i], bilinear_below(image.view(), x[i], y[i], limit[i])) << i;
    EXPECT_NEAR(grey[i], bilinear(cut.view(), x[i], y[i]), 1.0F) << i;  // its limits are whole grey levels
  }
}

}  // namespace
}  // namespace luminav
