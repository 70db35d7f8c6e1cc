#include "services/detector/bit_segmentation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace luminav {
namespace {

using Mask = std::vector<std::vector<bool>>;

GreyImage picture(int width, int height, std::uint8_t grey) {
  return {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), grey)};
}

std::uint8_t& pixel(GreyImage& image, int x, int y) {
  return image.pixels[static_cast<std::size_t>(y * image.width + x)];
}

/// Square window by the definition; beyond the picture counts as `outside`.
Mask extreme(const Mask& mask, int radius, bool erode) {
  const int height = static_cast<int>(mask.size());
  const int width = static_cast<int>(mask[0].size());
  Mask result(mask.size(), std::vector<bool>(mask[0].size()));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      bool all = true;
      bool any = false;
      for (int j = std::max(0, y - radius); j <= std::min(height - 1, y + radius); ++j) {
        for (int i = std::max(0, x - radius); i <= std::min(width - 1, x + radius); ++i) {
          const bool set = mask[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
          all = all && set;
          any = any || set;
        }
      }
      result[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = erode ? all : any;
    }
  }
  return result;
}

TEST(BitSegmentation, TakesWhatIsAboveOneThresholdOrNotAboveTheOther) {
  GreyImage image = picture(70, 3, 100);
  pixel(image, 3, 1) = 201;
  pixel(image, 10, 1) = 200;  // not above
  pixel(image, 65, 1) = 30;
  pixel(image, 68, 2) = 31;
  BitSegmentation segmentation;
  const auto& blobs = segmentation.find(image.view(), {.above = 200, .not_above = 30, .opening = 0, .least_pixels = 1});
  ASSERT_EQ(blobs.size(), 2U);
  EXPECT_EQ(blobs[0].x, 3.0);
  EXPECT_EQ(blobs[1].x, 65.0);
  EXPECT_EQ(blobs[1].y, 1.0);
}

TEST(BitSegmentation, OpensLikeTheDefinitionAtAnyWidth) {
  std::mt19937 rng(4);
  for (const int width : {37, 64, 100, 129}) {
    for (const int radius : {1, 2, 5}) {
      GreyImage image = picture(width, 41, 0);
      Mask mask(41, std::vector<bool>(static_cast<std::size_t>(width)));
      for (int blot = 0; blot < 12; ++blot) {
        const int left = static_cast<int>(rng() % static_cast<unsigned>(width));
        const int top = static_cast<int>(rng() % 41U);
        const int side = 1 + static_cast<int>(rng() % 14U);
        for (int y = top; y < std::min(41, top + side); ++y) {
          for (int x = left; x < std::min(width, left + side); ++x) {
            pixel(image, x, y) = 255;
            mask[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = true;
          }
        }
      }
      const Mask opened = extreme(extreme(mask, radius, true), radius, false);
      int expected = 0;
      for (const auto& row : opened) {
        expected += static_cast<int>(std::count(row.begin(), row.end(), true));
      }
      BitSegmentation segmentation;
      int pixels = 0;
      for (const Blob& blob :
           segmentation.find(image.view(), {.above = 128, .not_above = -1, .opening = radius, .least_pixels = 1})) {
        pixels += blob.pixels;
      }
      EXPECT_EQ(pixels, expected) << "width " << width << " radius " << radius;
    }
  }
}

TEST(BitSegmentation, MeasuresATurnedRectangle) {
  constexpr double kTheta = 0.4;
  GreyImage image = picture(320, 240, 50);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const double u = std::cos(kTheta) * (x - 150.3) + std::sin(kTheta) * (y - 120.6);
      const double v = -std::sin(kTheta) * (x - 150.3) + std::cos(kTheta) * (y - 120.6);
      if (std::abs(u) <= 60.0 && std::abs(v) <= 15.0) {
        pixel(image, x, y) = 250;
      }
    }
  }
  BitSegmentation segmentation;
  const auto& blobs =
      segmentation.find(image.view(), {.above = 200, .not_above = -1, .opening = 0, .least_pixels = 60});
  ASSERT_EQ(blobs.size(), 1U);
  EXPECT_NEAR(blobs[0].x, 150.3, 0.05);
  EXPECT_NEAR(blobs[0].y, 120.6, 0.05);
  EXPECT_NEAR(blobs[0].theta, kTheta, 0.003);
  EXPECT_NEAR(blobs[0].rectangle_theta, kTheta, 0.01);
  EXPECT_NEAR(blobs[0].length, 120.0, 1.0);
  EXPECT_NEAR(blobs[0].width, 30.0, 1.0);
}

TEST(BitSegmentation, JoinsAcrossCornersAndFurtherDown) {
  GreyImage image = picture(10, 4, 0);
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 1}, {4, 0}, {4, 1}, {3, 2}, {2, 2}, {8, 3}}) {
    pixel(image, x, y) = 255;
  }
  BitSegmentation segmentation;
  const auto& blobs = segmentation.find(image.view(), {.above = 128, .not_above = -1, .opening = 0, .least_pixels = 1});
  ASSERT_EQ(blobs.size(), 2U);
  EXPECT_EQ(blobs[0].pixels, 6);
}

}  // namespace
}  // namespace luminav
