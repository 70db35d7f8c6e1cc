#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "services/detector/sampling/grey_histogram.hpp"
#include "services/detector/sampling/raster.hpp"
#include "services/detector/segmentation/contrast_map.hpp"
#include "services/detector/segmentation/regions.hpp"

namespace luminav {
namespace {

Raster mask_of(const std::vector<std::string>& rows) {
  Raster mask(static_cast<int>(rows.size()), static_cast<int>(rows.front().size()), std::uint8_t{0});
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      mask(y, x) = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#' ? 255 : 0;
    }
  }
  return mask;
}

Raster random_raster(int width, int height, std::uint32_t seed) {
  std::mt19937 rng(seed);
  Raster raster(height, width);
  for (std::uint8_t& cell : raster) {
    cell = static_cast<std::uint8_t>(rng() % 256);
  }
  return raster;
}

int max_of(const Raster& raster) {
  return *std::max_element(raster.begin(), raster.end());
}

TEST(Reduce, TakesRoundedMeansOfSquares) {
  const std::vector<std::uint8_t> pixels{0, 2, 10, 10, 9,  //
                                         4, 7, 10, 11, 9};
  Raster reduced;
  reduce({5, 2, pixels}, 2, reduced);
  ASSERT_EQ(reduced.cols, 2);
  ASSERT_EQ(reduced.rows, 1);
  EXPECT_EQ(reduced(0, 0), 3);   // 13 / 4
  EXPECT_EQ(reduced(0, 1), 10);  // 41 / 4
  reduce({5, 2, pixels}, 2, reduced, 30);
  EXPECT_NEAR(reduced(0, 0), 97.5, 0.5);  // 390 / 4
  EXPECT_EQ(reduced(0, 1), 255);
}

TEST(Reduce, ByFourIsTheMeanOfSixteen) {
  const Raster image = random_raster(36, 12, 3);
  Raster reduced;
  reduce(view_of(image), 4, reduced);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 9; ++x) {
      EXPECT_NEAR(reduced(y, x), cv::mean(image(cv::Rect(4 * x, 4 * y, 4, 4)))[0], 1.0);
    }
  }
}

TEST(RegionFinder, JoinsPartsThatMeetFurtherDown) {
  RegionFinder finder;
  const auto& regions = finder.find(mask_of({"#...#..#", "#...#...", "##.##...", ".###...."}), 1);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].cells, 11);
  EXPECT_EQ(regions[0].left, 0);
  EXPECT_EQ(regions[0].right, 4);
  EXPECT_EQ(regions[0].bottom, 3);
  EXPECT_EQ(regions[1].cells, 1);
}

TEST(RegionFinder, JoinsAcrossCorners) {
  RegionFinder finder;
  EXPECT_EQ(finder.find(mask_of({"#.", ".#"}), 1).size(), 1U);
  EXPECT_EQ(finder.find(mask_of({"#..", "..#"}), 1).size(), 2U);
}

TEST(RegionFinder, LeavesOutWhatIsTooSmall) {
  RegionFinder finder;
  EXPECT_EQ(finder.find(mask_of({"##..#", "##..."}), 2).size(), 1U);
  EXPECT_TRUE(finder.find(mask_of({".....", "....."}), 1).empty());
}

TEST(RegionFinder, FindsEveryCellAboveTheLevelUpToTheLastOfARow) {
  RegionFinder finder;
  for (const int width : {1, 31, 32, 63, 64, 65, 96, 100, 128, 160, 200}) {
    const Raster image = random_raster(width, 3, static_cast<std::uint32_t>(width));
    for (const int level : {0, 100, 200, 254}) {
      Raster mask;
      cv::compare(image, level, mask, cv::CMP_GT);
      int cells = 0;
      for (const Region& region : finder.find(mask, 1)) {
        for (const auto& run : region.runs) {
          for (int x = run.first; x <= run.last; ++x) {
            ASSERT_GT(image(run.row, x), level);
          }
          cells += run.last - run.first + 1;
        }
      }
      EXPECT_EQ(cells, std::count_if(image.begin(), image.end(), [&](int cell) { return cell > level; }));
    }
  }
}

TEST(RegionFinder, FindsNothingNewInTheSameMaskTwice) {
  RegionFinder finder;
  Raster mask = random_raster(64, 48, 5);
  for (std::uint8_t& cell : mask) {
    cell = cell > 170 ? 255 : 0;
  }
  const std::size_t first = finder.find(mask, 1).size();
  EXPECT_EQ(finder.find(mask, 1).size(), first);
}

TEST(ContrastMap, IsBlindForASlopeAndForUniformGrey) {
  Raster image(60, 80);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      image(y, x) = static_cast<std::uint8_t>(40 + 2 * x);
    }
  }
  ContrastMap map;
  map.compute(image, 8, true);
  EXPECT_LE(max_of(map.dark()), 4);
}

TEST(ContrastMap, TakesTheNarrowestImages) {
  ContrastMap map;
  for (const int width : {2, 3, 8, 15, 16, 31, 32, 33}) {
    for (const int height : {2, 3, 8, 40}) {
      const Raster image(height, width, std::uint8_t{90});
      map.compute(image, 3, true);
      ASSERT_EQ(map.dark().size(), image.size());
      EXPECT_EQ(max_of(map.dark()), 0) << width << " x " << height;
    }
  }
}

TEST(ContrastMap, MeasuresADarkPatchBesideABrightOne) {
  Raster image(60, 80, std::uint8_t{100});
  for (int y = 20; y < 40; ++y) {
    for (int x = 0; x < 8; ++x) {
      image(y, x + 12) = 80;
      image(y, x + 50) = 250;
    }
  }
  ContrastMap map;
  map.compute(image, 8, true);
  EXPECT_NEAR(map.dark()(30, 16), 20, 4);
  EXPECT_LE(map.dark()(30, 35), 4);
  EXPECT_LT(map.eroded()(30, 12), map.dark()(30, 12));
  EXPECT_GT(map.eroded()(30, 16), 14);
}

TEST(ContrastMap, SeesNoDarkStripBetweenALampAndTheBorder) {
  Raster image(60, 80, std::uint8_t{100});
  for (int y = 20; y < 40; ++y) {
    for (int x = 4; x < 12; ++x) {
      image(y, x) = 250;
    }
  }
  ContrastMap map;
  map.compute(image, 8, true);
  EXPECT_LE(max_of(map.dark()), 6);
}

TEST(ContrastMap, SeesNoHollowBesideALampInItsBloom) {
  Raster image(120, 160);
  const double c = std::cos(0.6);
  const double s = std::sin(0.6);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double along = std::max(std::abs(c * (x - 45) + s * (y - 40)) - 19.0, 0.0);
      const double across = std::max(std::abs(-s * (x - 45) + c * (y - 40)) - 5.0, 0.0);
      image(y, x) =
          static_cast<std::uint8_t>(std::min(255.0, 70.0 + 150.0 * std::exp(-std::hypot(along, across) / 2.0)));
    }
  }
  ContrastMap map;
  map.compute(image, 14, true);
  EXPECT_LE(max_of(map.dark()), 5);
}

TEST(GreyHistogram, KnowsTheMedian) {
  const std::vector<std::uint8_t> grey{9, 3, 7, 3, 200};
  EXPECT_EQ(GreyHistogram(grey).median(), 7);
  EXPECT_EQ(GreyHistogram(grey, 2).median(), 9);  // 9, 7, 200
  EXPECT_EQ(GreyHistogram({}).median(), 0);
}

}  // namespace
}  // namespace luminav
