#include "services/surveyor/survey/straightening.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

SurveyEstimate askew(double turn) {
  SurveyEstimate estimate;
  const Pose2 map{3.0, -7.0, turn};
  for (int i = 0; i < 6; ++i) {
    estimate.fixtures.push_back({0, {i}, map * Pose2{0.0, 3.0 * i, i % 2 == 0 ? 0.0 : 0.5 * kPi}});
  }
  estimate.poses = {map, map * Pose2{1.0, 15.0, 0.0}};
  return estimate;
}

TEST(Straightening, FindsTheDirectionModuloAQuarterTurn) {
  const CeilingKinds kinds = synthetic_model().kinds;
  for (const double turn : {0.0, 0.3, 1.2, -2.0}) {
    EXPECT_NEAR(wrap_modulo(dominant_direction(askew(turn), kinds) - turn, 0.5 * kPi), 0.0, 1e-9);
  }
}

TEST(Straightening, LaysTheLongSideAlongXAndTheCornerAtTheOrigin) {
  SurveyEstimate estimate = askew(0.3);
  straighten(estimate, 0.3);
  double low = 1e9;
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    EXPECT_NEAR(wrap_modulo(fixture.world_from_fixture.theta, 0.5 * kPi), 0.0, 1e-9);
    EXPECT_GE(fixture.world_from_fixture.y, -1e-9);
    low = std::min(low, fixture.world_from_fixture.x);
  }
  EXPECT_NEAR(low, 0.0, 1e-9);
  EXPECT_NEAR(std::abs(estimate.fixtures[5].world_from_fixture.x - estimate.fixtures[0].world_from_fixture.x), 15.0,
              1e-9);
}

TEST(Straightening, MovesPosesAndFixturesTogether) {
  SurveyEstimate estimate = askew(0.3);
  estimate.dropped = {estimate.fixtures[2]};
  const Pose2 before = estimate.poses[1].inverse() * estimate.fixtures[2].world_from_fixture;
  transform(estimate, {1.0, 2.0, 0.7});
  for (const SurveyedFixture& fixture : {estimate.fixtures[2], estimate.dropped[0]}) {
    EXPECT_NEAR(distance(before, estimate.poses[1].inverse() * fixture.world_from_fixture), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace luminav
