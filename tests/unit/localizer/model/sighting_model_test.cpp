#include "services/localizer/model/sighting_model.hpp"

#include <gtest/gtest.h>

#include <random>

#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/localizer/model/error_model.hpp"

namespace luminav {
namespace {

FixtureSighting sighting_at(double x, double y, double theta) {
  FixtureSighting sighting;
  sighting.robot_from_fixture = {x, y, theta};
  sighting.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal();
  sighting.length = 1.2;
  sighting.width = 0.3;
  return sighting;
}

TEST(SightingModel, ExpectsAFixtureAheadOfARobotThatLooksNorth) {
  const ExpectedSighting expected = expect_sighting({1.0, 2.0, 0.5 * kPi}, {1.0, 3.0, 0.5 * kPi});
  EXPECT_NEAR(expected.robot_from_fixture.x, 1.0, 1e-12);
  EXPECT_NEAR(expected.robot_from_fixture.y, 0.0, 1e-12);
  EXPECT_NEAR(expected.robot_from_fixture.theta, 0.0, 1e-12);
}

TEST(SightingModel, JacobianAgreesWithDifferences) {
  std::mt19937 rng(42);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  for (int i = 0; i < 50; ++i) {
    const Pose2 pose{uniform(rng), uniform(rng), uniform(rng)};
    const Pose2 fixture{uniform(rng), uniform(rng), uniform(rng)};
    const ExpectedSighting here = expect_sighting(pose, fixture);
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      Pose2 moved = pose;
      (axis == 0 ? moved.x : axis == 1 ? moved.y : moved.theta) += kStep;
      const ExpectedSighting there = expect_sighting(moved, fixture);
      EXPECT_NEAR((there.robot_from_fixture.x - here.robot_from_fixture.x) / kStep, here.jacobian(0, axis), 1e-5);
      EXPECT_NEAR((there.robot_from_fixture.y - here.robot_from_fixture.y) / kStep, here.jacobian(1, axis), 1e-5);
      EXPECT_NEAR(wrap_angle(there.robot_from_fixture.theta - here.robot_from_fixture.theta) / kStep,
                  here.jacobian(2, axis), 1e-5);
    }
  }
}

TEST(SightingModel, HalfATurnOfARectangleChangesNothing) {
  const Pose2 expected{1.0, 0.0, 0.3};
  const Eigen::Vector3d one = sighting_residual(sighting_at(1.1, 0.0, 0.4), expected, FixtureShape::kRectangle);
  const Eigen::Vector3d other = sighting_residual(sighting_at(1.1, 0.0, 0.4 - kPi), expected, FixtureShape::kRectangle);
  EXPECT_NEAR((one - other).norm(), 0.0, 1e-9);
  EXPECT_NEAR(one.z(), 0.1, 1e-9);
}

TEST(SightingModel, ARoundFixtureHasNoHeading) {
  EXPECT_EQ(sighting_residual(sighting_at(0.0, 0.0, 1.2), {0.0, 0.0, 0.0}, FixtureShape::kRound).z(), 0.0);
}

TEST(SightingModel, CorrectionOfEqualVariancesMeetsInTheMiddle) {
  PoseBelief belief{{0.0, 0.0, 0.0}, Eigen::Vector3d(0.01, 0.01, 1e-8).asDiagonal()};
  Fixture fixture;
  fixture.world_from_fixture = {1.0, 0.0, 0.0};
  const Eigen::Matrix3d noise = Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal();
  // the fixture is seen 0.2 m nearer than believed: the robot is 0.2 m further on, half of which is taken
  const Innovation innovation = innovate(belief, sighting_at(0.8, 0.0, 0.0), fixture, noise);
  EXPECT_NEAR(innovation.nis, 0.04 / 0.02, 1e-6);
  correct(belief, innovation, noise);
  EXPECT_NEAR(belief.pose.x, 0.1, 1e-9);
  EXPECT_NEAR(belief.covariance(0, 0), 0.005, 1e-9);
}

TEST(SightingModel, PredictionTurnsHeadingDoubtIntoSidewaysDoubt) {
  PoseBelief belief{{0.0, 0.0, 0.0}, Eigen::Vector3d(0.0, 0.0, 0.01).asDiagonal()};
  predict(belief, {2.0, 0.0, 0.0}, Eigen::Matrix3d::Zero());
  EXPECT_NEAR(belief.pose.x, 2.0, 1e-12);
  EXPECT_NEAR(belief.covariance(1, 1), 0.04, 1e-12);
  EXPECT_NEAR(belief.covariance(0, 0), 0.0, 1e-12);
}

TEST(ErrorModel, NoiseGrowsWithTheWay) {
  const ErrorParams params;
  const Eigen::Matrix3d one = odometry_noise({1.0, 0.0, 0.0}, 0.33, params);
  EXPECT_NEAR(one(0, 0), 1e-4, 1e-12);
  EXPECT_NEAR(one(2, 2), radians(0.5) * radians(0.5), 1e-12);
  EXPECT_NEAR(odometry_noise({0.0, 0.0, 0.0}, 0.33, params).norm(), 0.0, 1e-15);
}

TEST(FixtureMap, FindsWhatLiesNearAndOnlyThat) {
  std::vector<Fixture> fixtures(3);
  fixtures[0].world_from_fixture = {0.0, 0.0, 0.0};
  fixtures[1].world_from_fixture = {2.4, 0.0, 0.0};
  fixtures[2].world_from_fixture = {40.0, 30.0, 0.0};
  const FixtureMap map(fixtures);
  EXPECT_EQ(map.near({0.5, 0.0}, 2.0), (std::vector<int>{0, 1}));
  EXPECT_NEAR(map.smallest_spacing(), 2.4, 1e-12);
}

TEST(FixtureMap, IsEmptyWithoutFixtures) {
  const FixtureMap map({});
  EXPECT_TRUE(map.near({0.0, 0.0}, 100.0).empty());
}

TEST(FixtureMap, TellsOneLampFromTwoLampFixtures) {
  Fixture two_lamps;
  Fixture one_lamp;
  one_lamp.width = 0.15;
  EXPECT_TRUE(fits_kind_and_size(sighting_at(0, 0, 0), two_lamps, KindGate{}));
  EXPECT_FALSE(fits_kind_and_size(sighting_at(0, 0, 0), one_lamp, KindGate{}));
  FixtureSighting half = sighting_at(0, 0, 0);
  half.width = 0.15;
  EXPECT_FALSE(fits_kind_and_size(half, two_lamps, KindGate{}));
  half.state = SightingState::kHalf;
  EXPECT_TRUE(fits_kind_and_size(half, two_lamps, KindGate{}));
}

TEST(FixtureMap, TakesACutFixtureThatSeemsHalfLitForABurningOneOfHalfItsWidthToo) {
  Fixture one_lamp;
  one_lamp.length = 1.2;
  one_lamp.width = 0.15;
  FixtureSighting half = sighting_at(0, 0, 0);
  half.state = SightingState::kHalf;
  half.length = 0.7;
  half.clipped = true;
  EXPECT_TRUE(fits_kind_and_size(half, one_lamp, KindGate{}));
  one_lamp.width = 0.04;
  EXPECT_FALSE(fits_kind_and_size(half, one_lamp, KindGate{}));
  one_lamp.width = 0.15;
  half.state = SightingState::kLit;
  EXPECT_FALSE(fits_kind_and_size(half, one_lamp, KindGate{}));
}

TEST(ErrorModel, AStretchWithoutEndsMayLieAnywhereAlongItsFixture) {
  FixtureSighting stretch = sighting_at(1.0, 0.0, 0.5 * kPi);
  stretch.length = 0.3;
  stretch.clipped = true;
  Fixture fixture;
  fixture.length = 1.2;
  fixture.width = 0.3;
  const ErrorParams errors;
  const Eigen::Matrix3d with_ends = white_sighting_covariance(stretch, fixture, errors);
  stretch.near_end_visible = stretch.far_end_visible = false;
  const Eigen::Matrix3d without = white_sighting_covariance(stretch, fixture, errors);
  const double uniform = 0.9 / std::sqrt(12.0);  // [m] sigma
  EXPECT_NEAR(without(1, 1) - with_ends(1, 1), uniform * uniform, 1e-5);
  EXPECT_NEAR(without(0, 0), with_ends(0, 0), 1e-9);
  fixture.length = 0.3;
  EXPECT_EQ(white_sighting_covariance(stretch, fixture, errors), with_ends);
}

TEST(FixtureMap, TakesABloomingLampForNoWiderFixture) {
  Fixture two_lamps;
  Fixture one_lamp;
  one_lamp.width = 0.15;
  FixtureSighting blooming = sighting_at(0, 0, 0);
  blooming.width = 0.24;  // of 0.15, as measured in a room of few lamps
  EXPECT_FALSE(fits_kind_and_size(blooming, one_lamp, KindGate{}));
  blooming.state = SightingState::kLit;
  EXPECT_TRUE(fits_kind_and_size(blooming, one_lamp, KindGate{}));
  blooming.width = 0.39;  // of 0.30
  EXPECT_TRUE(fits_kind_and_size(blooming, two_lamps, KindGate{}));
  EXPECT_FALSE(fits_kind_and_size(blooming, one_lamp, KindGate{}));
  blooming.clipped = true;
  EXPECT_TRUE(fits_kind_and_size(blooming, two_lamps, KindGate{}));
}

TEST(CeilingView, SeesAllOfAFixtureOverheadAndNothingFarAway) {
  CameraDescription camera;
  camera.mounting.z = 0.3;
  const CeilingView view(camera);
  Fixture fixture;
  EXPECT_EQ(view.visible_share({0.0, 0.0, 0.0}, fixture, 0.1), 1.0);
  EXPECT_EQ(view.visible_share({4.0, 0.0, 0.0}, fixture, 0.0), 0.0);
  const double half = view.visible_share({0.0, 2.5 * 239.5 / 554.0 * 640.0 / 480.0, 0.5 * kPi}, fixture, 0.0);
  EXPECT_NEAR(half, 0.5, 0.13);
}

TEST(CeilingView, UndoesTheRollingShutterOfATurningRobot) {
  CameraDescription camera;
  camera.mounting.z = 0.3;
  const CeilingView view(camera);
  // At 1 rad/s a point 1 m ahead, 221 rows above the middle, was read 11.5 ms before the middle row and had then been
  // 11.5 mm further left than when the middle row was read.
  const double late = -554.0 / 2.5 * camera.row_time;
  const FixtureSighting seen = sighting_at(1.0, 0.0, 0.0);
  const FixtureSighting corrected = view.without_rolling_shutter(seen, 2.8, 0.0, 1.0);
  EXPECT_NEAR(corrected.robot_from_fixture.y, late * 1.0, 1e-4);
  EXPECT_NEAR(view.without_rolling_shutter(seen, 2.8, 0.0, 0.0).robot_from_fixture.y, 0.0, 1e-12);
}

}  // namespace
}  // namespace luminav
