#include "drivers/simulator/geometry/random_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/simulator/world/floor.hpp"
#include "services/common/geometry/split_mix.hpp"

namespace luminav {
namespace {

TEST(SplitMix, FollowsThePublishedSequence) {
  // splitmix64 from state 0, first two values of Vigna's reference implementation
  SplitMix generator(0);
  EXPECT_EQ(generator.next(), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(generator.next(), 0x6e789e6aa1b965f4ULL);
}

TEST(RandomStream, DrawsAGaussianOfTheWantedWidth) {
  RandomStream random(42, "test");
  constexpr int kDraws = 100'000;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.gaussian(2.0);
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 4.0 * 2.0 / std::sqrt(kDraws));
  EXPECT_NEAR(std::sqrt(squares / kDraws), 2.0, 0.02);
}

TEST(RandomStream, IsAnotherForEachSeedPurposeAndIndex) {
  const double first = RandomStream(1, "camera").uniform();
  EXPECT_EQ(first, RandomStream(1, "camera").uniform());
  EXPECT_NE(first, RandomStream(2, "camera").uniform());
  EXPECT_NE(first, RandomStream(1, "wheels").uniform());
  EXPECT_NE(first, RandomStream(1, "camera", 1).uniform());
}

TEST(RandomStream, FirstDrawsOfNeighbouringSeedsAreIndependent) {
  constexpr int kSeeds = 20'000;
  double squares = 0.0;
  double products = 0.0;
  double previous = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const double value = RandomStream(static_cast<std::uint64_t>(seed), "camera").gaussian(1.0);
    squares += value * value;
    products += value * previous;
    previous = value;
  }
  EXPECT_NEAR(squares / kSeeds, 1.0, 4.0 * std::sqrt(2.0 / kSeeds));
  EXPECT_NEAR(products / kSeeds, 0.0, 4.0 / std::sqrt(kSeeds));
}

TEST(Floor, TiltsByTheWantedDeviationEverywhereAndWithoutSteps) {
  constexpr double kTilt = 0.002;
  double squares = 0.0;
  constexpr int kFloors = 20'000;
  for (int seed = 0; seed < kFloors; ++seed) {
    squares += Floor(kTilt, static_cast<std::uint64_t>(seed)).tilt_at({3.4, -1.7}).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / (2.0 * kFloors)), kTilt, 0.02 * kTilt);

  Floor floor(kTilt, 7);
  Eigen::Vector2d previous = floor.tilt_at({-2.0, 0.3});
  double largest = 0.0;
  double change = 0.0;
  for (double x = -2.0; x < 8.0; x += 0.001) {
    const Eigen::Vector2d tilt = floor.tilt_at({x, 0.3});
    largest = std::max(largest, (tilt - previous).norm());
    change += (tilt - previous).norm();
    previous = tilt;
  }
  EXPECT_LT(largest, 0.02 * kTilt);  // millimetre by millimetre
  EXPECT_GT(change, 5.0 * kTilt);    // but another one on each of the ten metres
}

}  // namespace
}  // namespace luminav
