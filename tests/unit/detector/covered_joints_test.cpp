#include "services/detector/covered_joints.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
