#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "services/detector/sampling/grey_histogram.hpp"
#include "services/detector/sampling/raster.hpp"
#include "services/detector/segmentation/contrast_map.hpp"
#include "services/detector/segmentation/regions.hpp"

namespace luminav {
namespace {

Raster raster_of(const std::vector<std::string>& rows) {
  Raster raster;
  raster.resize(static_cast<int>(rows.front().size()), static_cast<int>(rows.size()));
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      raster.row(y)[x] = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#' ? 1 : 0;
    }
  }
  return raster;
}

Raster random_raster(int width, int height, std::uint32_t seed) {
  std::mt19937 rng(seed);
  Raster raster;
  raster.resize(width, height);
  for (std::uint8_t& cell : raster.cells) {
    cell = static_cast<std::uint8_t>(rng() % 256);
  }
  return raster;
}

TEST(Negate, TakesGreyLevelsFromWhite) {
  std::vector<std::uint8_t> negative;
  negate(std::vector<std::uint8_t>{0, 3, 255}, negative);
  EXPECT_EQ(negative, (std::vector<std::uint8_t>{255, 252, 0}));
}

TEST(Reduce, TakesRoundedMeansOfSquares) {
  const std::vector<std::uint8_t> pixels{0, 2, 10, 10, 9,  //
                                         4, 7, 10, 11, 9};
  Raster reduced;
  reduce({5, 2, pixels}, 2, reduced);
  ASSERT_EQ(reduced.width, 2);
  ASSERT_EQ(reduced.height, 1);
  EXPECT_EQ(reduced.row(0)[0], 3);   // 13 / 4
  EXPECT_EQ(reduced.row(0)[1], 10);  // 41 / 4
  reduce({5, 2, pixels}, 2, reduced, 30);
  EXPECT_EQ(reduced.row(0)[0], 98);  // 390 / 4
  EXPECT_EQ(reduced.row(0)[1], 255);
}

TEST(Reduce, ByFourEqualsTheMeanOfSixteen) {
  const Raster image = random_raster(36, 12, 3);
  Raster reduced;
  reduce({36, 12, image.cells}, 4, reduced);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 9; ++x) {
      int sum = 0;
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i) {
          sum += image.row(4 * y + j)[4 * x + i];
        }
      }
      EXPECT_EQ(reduced.row(y)[x], (sum + 8) / 16);
    }
  }
}

TEST(Morphology, EqualsTheExtremesCountedByHand) {
  for (const int radius : {1, 2, 3, 7, 11}) {
    const Raster image = random_raster(37, 29, static_cast<std::uint32_t>(radius));
    Raster dilated;
    Raster eroded;
    Raster scratch;
    dilate(image, radius, dilated, scratch);
    erode(image, radius, eroded, scratch);
    Raster largest;  // where the border is out of reach
    Raster smallest;
    Raster lost = image;
    dilate_within(lost, radius, largest);
    lost = image;
    erode_within(lost, radius, smallest);
    ASSERT_EQ(largest.width, image.width - 2 * radius);
    ASSERT_EQ(largest.height, image.height - 2 * radius);
    ASSERT_EQ(smallest.cells.size(), largest.cells.size());
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        int most = 0;
        int least = 255;
        for (int j = std::max(0, y - radius); j <= std::min(image.height - 1, y + radius); ++j) {
          for (int i = std::max(0, x - radius); i <= std::min(image.width - 1, x + radius); ++i) {
            most = std::max<int>(most, image.row(j)[i]);
            least = std::min<int>(least, image.row(j)[i]);
          }
        }
        ASSERT_EQ(dilated.row(y)[x], most) << "radius " << radius << " at " << x << ", " << y;
        ASSERT_EQ(eroded.row(y)[x], least) << "radius " << radius << " at " << x << ", " << y;
        const int i = x - radius;
        const int j = y - radius;
        if (i >= 0 && j >= 0 && i < largest.width && j < largest.height) {
          ASSERT_EQ(largest.row(j)[i], most) << "radius " << radius << " at " << x << ", " << y;
          ASSERT_EQ(smallest.row(j)[i], least) << "radius " << radius << " at " << x << ", " << y;
        }
      }
    }
  }
}

TEST(RegionFinder, JoinsPartsThatMeetFurtherDown) {
  RegionFinder finder;
  const auto& regions = finder.find(raster_of({"#...#..#", "#...#...", "##.##...", ".###...."}), 1);
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].cells, 11);
  EXPECT_EQ(regions[0].left, 0);
  EXPECT_EQ(regions[0].right, 4);
  EXPECT_EQ(regions[0].bottom, 3);
  EXPECT_EQ(regions[1].cells, 1);
}

TEST(RegionFinder, JoinsAcrossCorners) {
  RegionFinder finder;
  EXPECT_EQ(finder.find(raster_of({"#.", ".#"}), 1).size(), 1U);
  EXPECT_EQ(finder.find(raster_of({"#..", "..#"}), 1).size(), 2U);
}

TEST(RegionFinder, LeavesOutWhatIsTooSmall) {
  RegionFinder finder;
  EXPECT_EQ(finder.find(raster_of({"##..#", "##..."}), 2).size(), 1U);
  EXPECT_TRUE(finder.find(raster_of({".....", "....."}), 1).empty());
}

TEST(RegionFinder, FindsEveryCellAboveTheLevelUpToTheLastOfARow) {
  RegionFinder finder;
  for (const int width : {1, 31, 32, 63, 64, 65, 96, 100, 128, 160, 200}) {
    Raster image = random_raster(width, 3, static_cast<std::uint32_t>(width));
    for (const int level : {0, 100, 200, 254}) {
      int cells = 0;
      for (const Region& region : finder.find(image, 1, level)) {
        for (const auto& run : region.runs) {
          for (int x = run.first; x <= run.last; ++x) {
            ASSERT_GT(image.row(run.row)[x], level);
          }
          cells += run.last - run.first + 1;
        }
      }
      EXPECT_EQ(cells, std::count_if(image.cells.begin(), image.cells.end(), [&](int cell) { return cell > level; }));
    }
  }
}

TEST(RegionFinder, FindsNothingNewInTheSameMaskTwice) {
  RegionFinder finder;
  Raster mask = random_raster(64, 48, 5);
  for (std::uint8_t& cell : mask.cells) {
    cell = cell > 170 ? 1 : 0;
  }
  const std::size_t first = finder.find(mask, 1).size();
  EXPECT_EQ(finder.find(mask, 1).size(), first);
}

TEST(ContrastMap, IsBlindForASlopeAndForUniformGrey) {
  Raster image;
  image.resize(80, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      image.row(y)[x] = static_cast<std::uint8_t>(40 + 2 * x);
    }
  }
  ContrastMap map;
  map.compute(image, 8, true);
  EXPECT_LE(*std::max_element(map.dark().cells.begin(), map.dark().cells.end()), 4);
}

// Rows are worked on in whole vectors: of the narrowest images one spans many rows. Sanitized builds say more.
TEST(ContrastMap, TakesImagesNarrowerThanAVector) {
  ContrastMap map;
  for (const int width : {2, 3, 8, 15, 16, 31, 32, 33}) {
    for (const int height : {2, 3, 8, 40}) {
      Raster image;
      image.resize(width, height);
      std::fill(image.cells.begin(), image.cells.end(), std::uint8_t{90});
      map.compute(image, 3, true);
      ASSERT_EQ(map.dark().cells.size(), image.cells.size());
      EXPECT_EQ(*std::max_element(map.dark().cells.begin(), map.dark().cells.end()), 0) << width << " x " << height;
    }
  }
}

TEST(ContrastMap, MeasuresADarkPatchBesideABrightOne) {
  Raster image;
  image.resize(80, 60);
  std::fill(image.cells.begin(), image.cells.end(), std::uint8_t{100});
  for (int y = 20; y < 40; ++y) {
    for (int x = 0; x < 8; ++x) {
      image.row(y)[x + 12] = 80;
      image.row(y)[x + 50] = 250;
    }
  }
  ContrastMap map;
  map.compute(image, 8, true);
  EXPECT_NEAR(map.dark().row(30)[16], 20, 4);
  EXPECT_LE(map.dark().row(30)[35], 4);
  EXPECT_LT(map.eroded().row(30)[12], map.dark().row(30)[12]);
  EXPECT_GT(map.eroded().row(30)[16], 14);
}

TEST(ContrastMap, SeesNoDarkStripBetweenALampAndTheBorder) {
  Raster image;
  image.resize(80, 60);
  std::fill(image.cells.begin(), image.cells.end(), std::uint8_t{100});
  for (int y = 20; y < 40; ++y) {
    for (int x = 4; x < 12; ++x) {
      image.row(y)[x] = 250;
    }
  }
  ContrastMap map;
  map.compute(image, 8, true);
  EXPECT_LE(*std::max_element(map.dark().cells.begin(), map.dark().cells.end()), 6);
}

TEST(ContrastMap, SeesNoHollowBesideALampInItsBloom) {
  Raster image;
  image.resize(160, 120);
  const double c = std::cos(0.6);
  const double s = std::sin(0.6);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double along = std::max(std::abs(c * (x - 45) + s * (y - 40)) - 19.0, 0.0);
      const double across = std::max(std::abs(-s * (x - 45) + c * (y - 40)) - 5.0, 0.0);
      image.row(y)[x] =
          static_cast<std::uint8_t>(std::min(255.0, 70.0 + 150.0 * std::exp(-std::hypot(along, across) / 2.0)));
    }
  }
  ContrastMap map;
  map.compute(image, 14, true);
  EXPECT_LE(*std::max_element(map.dark().cells.begin(), map.dark().cells.end()), 5);
}

TEST(GreyHistogram, KnowsTheMedian) {
  const std::vector<std::uint8_t> grey{9, 3, 7, 3, 200};
  EXPECT_EQ(GreyHistogram(grey).median(), 7);
  EXPECT_EQ(GreyHistogram(grey, 2).median(), 9);  // 9, 7, 200
  EXPECT_EQ(GreyHistogram({}).median(), 0);
}

}  // namespace
}  // namespace luminav
