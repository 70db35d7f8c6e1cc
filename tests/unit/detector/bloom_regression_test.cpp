#include "services/detector/bloom_regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace luminav {
namespace {

constexpr double kLength = 1.2;  // [m] of the sides
constexpr double kPixel = 4e-3;  // [m]
constexpr std::size_t kSaturated = 3;
constexpr double kApart = 70.0;  // [px] from one side to the other
constexpr double kJoint = 25.0;  // [grey] its height in the light's profile

double light_at(double k) {
  return 90.0 * std::exp(-k / 5.0);
}

double joint_at(double k, double place) {
  return kJoint * std::exp(-0.5 * std::pow((k - place) / 1.3, 2));
}

/// Of profiles that are saturated at first.
template <typename Light>
Differences differences_between(const Light& positive, const Light& negative, std::mt19937& rng) {
  std::normal_distribution<double> noise(0.0, 2.0);  // [grey] of a stretch's mean
  Differences differences;
  differences.apart = kApart;
  for (std::size_t k = 0; k < Differences::kDistances; ++k) {
    const auto at = static_cast<double>(k);
    for (std::size_t s = 0; s < Differences::kStretches; ++s) {
      differences.value[s][k] = static_cast<float>(positive(at) - negative(at) + noise(rng));
      differences.valid[s][k] = k >= kSaturated;
      differences.count += k >= kSaturated ? 1 : 0;
    }
    differences.fall[0][k] = 0.5 * (positive(at - 1.0) - positive(at + 1.0));
    differences.fall[1][k] = 0.5 * (negative(at - 1.0) - negative(at + 1.0));
  }
  for (std::size_t s = 0; s < Differences::kStretches; ++s) {
    differences.place[s] = kLength * ((static_cast<double>(s) + 0.5) / Differences::kStretches - 0.5);
  }
  return differences;
}

/// Of a lamp that lies `shift` [px] towards its positive side, with a joint `place` [px] outwards of that side's first
/// distance.
Differences differences_beside_a_joint(double shift, double place, std::mt19937& rng) {
  using Light = std::function<double(double)>;
  return differences_between<Light>([&](double x) { return light_at(x - shift) - joint_at(x, place); },
                                    [&](double x) { return light_at(x + shift); }, rng);
}

/// Of one on a ceiling that grows brighter by `slope` [grey/px] towards the positive side.
Differences differences_on_a_slope(double shift, double slope, std::mt19937& rng) {
  using Light = std::function<double(double)>;
  const auto from_middle = [](double x) { return 0.5 * kApart + x - Differences::kInside; };
  return differences_between<Light>([&](double x) { return light_at(x - shift) + slope * from_middle(x); },
                                    [&](double x) { return light_at(x + shift) - slope * from_middle(x); }, rng);
}

/// RMS of the error [px] over lamps and slopes, with or without the distance between the sides.
double error_on_slopes(bool distance_is_known) {
  std::mt19937 rng(7);
  double squares = 0.0;
  int count = 0;
  for (const double shift : {-0.4, -0.2, 0.0, 0.2, 0.4}) {
    for (const double slope : {-0.6, -0.4, 0.4, 0.6}) {
      Differences differences = differences_on_a_slope(shift, slope, rng);
      differences.apart = distance_is_known ? kApart : 1e9;
      constexpr KnownJoint kNone{.is_known = true};
      const auto balance = balance_sides(differences, kLength, kPixel, {kNone, kNone});
      EXPECT_TRUE(balance) << shift << ' ' << slope;
      squares += balance ? std::pow(balance->shift / kPixel - shift, 2) : 0.0;
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

/// RMS of the error [px] over lamps, with what is known of the joint beside them.
double error_beside_joints(bool depth_is_known) {
  std::mt19937 rng(7);
  double squares = 0.0;
  int count = 0;
  for (const double shift : {-0.4, -0.2, 0.0, 0.2, 0.4}) {
    for (const double place : {1.0, 1.5, 2.0, 2.5, 3.0}) {
      KnownJoints joints{KnownJoint{.is_known = depth_is_known, .is_there = true, .place = place, .depth = 20.0},
                         KnownJoint{.is_known = true, .is_there = false}};
      const auto balance = balance_sides(differences_beside_a_joint(shift, place, rng), kLength, kPixel, joints);
      EXPECT_TRUE(balance) << shift << ' ' << place;
      squares += balance ? std::pow(balance->shift / kPixel - shift, 2) : 0.0;
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

TEST(BloomRegression, TellsAShiftFromACeilingThatGrowsBrighterToOneSide) {
  const double known = error_on_slopes(true);
  EXPECT_LT(known, 0.06);
  EXPECT_LT(known, 0.5 * error_on_slopes(false));
}

TEST(BloomRegression, IsLessSureWhereOneSideIsMuchBrighter) {
  std::mt19937 rng(7);
  constexpr KnownJoint kNone{.is_known = true};
  const auto even = balance_sides(differences_on_a_slope(0.2, 0.0, rng), kLength, kPixel, {kNone, kNone});
  const auto uneven = balance_sides(differences_on_a_slope(0.2, 0.8, rng), kLength, kPixel, {kNone, kNone});
  ASSERT_TRUE(even && uneven);
  EXPECT_GT(uneven->covariance(0, 0), 4.0 * even->covariance(0, 0));
}

TEST(BloomRegression, TakesAJointForAsDeepAsItIsBeyondTheCorners) {
  const double known = error_beside_joints(true);
  EXPECT_LT(known, 0.1);
  EXPECT_LT(known, 0.9 * error_beside_joints(false));
}

/// What is off from everything that the regression knows, 1 sigma [grey].
Differences disturbed(Differences differences, float sigma, std::mt19937& rng) {
  std::normal_distribution<float> scatter(0.0F, sigma);
  for (auto& stretch : differences.value) {
    for (float& value : stretch) {
      value += scatter(rng);
    }
  }
  return differences;
}

TEST(BloomRegression, IsLessSureOfDifferencesThatScatterMoreThanNoise) {
  constexpr KnownJoint kNone{.is_known = true};
  std::mt19937 rng(11);
  double calm = 0.0;
  double restless = 0.0;
  for (int lamp = 0; lamp < 10; ++lamp) {
    const Differences differences = differences_on_a_slope(0.2, 0.3, rng);
    const auto quiet = balance_sides(differences, kLength, kPixel, {kNone, kNone});
    const auto loud = balance_sides(disturbed(differences, 4.0F, rng), kLength, kPixel, {kNone, kNone});
    ASSERT_TRUE(quiet && loud);
    calm += quiet->covariance(0, 0);
    restless += loud->covariance(0, 0);
  }
  EXPECT_GT(restless, 2.0 * calm);
}

TEST(BloomRegression, BalancesSidesOfWhichMostDifferencesAreOffByMoreThanNoise) {
  constexpr KnownJoint kNone{.is_known = true};
  std::mt19937 rng(11);
  double squares = 0.0;
  constexpr int kLamps = 10;
  for (int lamp = 0; lamp < kLamps; ++lamp) {
    const Differences differences = disturbed(differences_on_a_slope(0.4, 0.3, rng), 10.0F, rng);
    const auto balance = balance_sides(differences, kLength, kPixel, {kNone, kNone});
    ASSERT_TRUE(balance) << lamp;
    squares += std::pow(balance->shift / kPixel - 0.4, 2);
  }
  EXPECT_LT(std::sqrt(squares / kLamps), 0.2) << "px";
}

}  // namespace
}  // namespace luminav
