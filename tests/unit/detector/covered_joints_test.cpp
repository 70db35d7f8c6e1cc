#include "services/detector/covered_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

/// As of an end `place` steps outwards whose place is known to `sigma` steps.
EndCosts costs_around(double place, double sigma) {
  EndCosts costs;
  for (auto& of_blur : costs.cost) {
    for (std::size_t i = 0; i < EndCosts::kPlaces; ++i) {
      of_blur[i] = std::pow((static_cast<double>(i) - EndCosts::kReach - place) / sigma, 2);
    }
  }
  return costs;
}

/// Where the profiles of both ends place a faint fixture that lies `off` [m] ahead of where it was thought to be.
std::optional<PlaceBetween> place_of_faint_fixture(double off, std::uint32_t seed) {
  constexpr double kHeight = 2.8;  // [m]
  const CameraDescription description = test::test_camera();
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {off, 0.0, 0.0}, .state = DetectionState::kUnlit, .darker = 8.0}};
  ceiling.noise = 6.0;
  ceiling.seed = seed;
  const GreyImage image = test::draw_ceiling(ceiling, description, kHeight);
  const CeilingCamera camera(description.intrinsics, description.mounting);
  const auto costs = [&](double sign) {
    const SideLine end{
        .pose = {}, .height = kHeight, .along = {0.0, 1.0}, .out = {sign, 0.0}, .half_length = 0.15, .distance = 0.6};
    return end_costs(image.view(), camera, end, 0.004, ceiling.noise, CeilingOutside::kEven);
  };
  const auto far = costs(1.0);
  const auto near = costs(-1.0);
  return far && near ? place_between(*far, *near, 0.6) : std::nullopt;
}

TEST(CoveredJoints, PlaceAFaintFixtureByTheGreyLevelsOfItsWholeEnds) {
  constexpr int kPictures = 20;
  double squares = 0.0;
  double normalised = 0.0;
  for (int i = 0; i < kPictures; ++i) {
    const double off = -0.009 + 0.001 * i;
    const auto place = place_of_faint_fixture(off, static_cast<std::uint32_t>(i + 1));
    ASSERT_TRUE(place) << off;
    squares += std::pow(place->shift - off, 2);
    normalised += std::pow(place->shift - off, 2) / place->variance;
  }
  EXPECT_LT(std::sqrt(squares / kPictures), 1.2e-3) << "a quarter of a pixel, with a step of 1.3 sigmas of noise";
  EXPECT_LT(normalised / kPictures, 1.7);  // chi squared of 20 values exceeds it once in 36 times
}

TEST(CoveredJoints, PlaceALoneEndWhereItsCostsAreLeast) {
  const auto place = place_of(costs_around(6.0, 2.0));
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->shift, 6.0 * EndCosts::kStep, 1e-6);
  EXPECT_NEAR(std::sqrt(place->variance), 2.0 * EndCosts::kStep, 0.05 * EndCosts::kStep);
}

TEST(CoveredJoints, SayNothingWhenTheBorderOfTheSearchIsBest) {
  for (const double beyond : {-45.0, 45.0}) {
    EXPECT_FALSE(place_of(costs_around(beyond, 2.0)));
    EXPECT_FALSE(place_between(costs_around(beyond, 2.0), costs_around(-beyond, 2.0), 0.6));
  }
}

TEST(CoveredJoints, PlaceAnOutlineWhereBothSidesAgree) {
  const auto place = place_between(costs_around(5.0, 1.0), costs_around(-3.0, 1.0), 0.6);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->shift, 4.0 * EndCosts::kStep, 0.1 * EndCosts::kStep);
}

}  // namespace
}  // namespace luminav
