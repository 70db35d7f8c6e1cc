#include "services/localizer/tracking/tracking_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace luminav {
namespace {

FixtureSighting overhead() {
  FixtureSighting sighting;
  sighting.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal();
  sighting.length = 1.2;
  sighting.width = 0.3;
  return sighting;
}

TEST(TrackingFilter, LookingForLongDoesNotMakeItSurerThanCameraAndFixture) {
  const ErrorParams errors;
  TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, errors);
  filter.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(0.04, 0.04, 0.04).asDiagonal()});
  Fixture fixture;
  for (int i = 0; i < 1000; ++i) {
    filter.correct(overhead(), 0, fixture, 0.0, 0.0, 0.0);
  }
  // tilt of camera and floor at 2.5 m, and the fixture's own place
  const double tilt = 2.5 * std::hypot(errors.camera_tilt, errors.floor_tilt);
  const double min = tilt * tilt + errors.fixture_position * errors.fixture_position;
  EXPECT_GT(filter.belief().covariance(0, 0), 0.9 * min * 0.04 / (0.04 + min));
  EXPECT_GT(filter.belief().covariance(2, 2), 0.9 * 2.0 * std::pow(radians(0.5), 2));
}

TEST(TrackingFilter, CovarianceStaysPositiveOverALongDrive) {
  TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
  filter.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(0.04, 0.04, 0.04).asDiagonal()});
  for (int i = 0; i < 5000; ++i) {
    filter.predict({0.03, 0.0, 0.0});
    Fixture fixture;
    fixture.world_from_fixture = {0.03 * (i + 1), 0.0, 0.0};
    filter.correct(overhead(), i / 80, fixture, 0.45, 0.0, 0.03 * i);
  }
  const Eigen::SelfAdjointEigenSolver<TrackingFilter::Covariance> solver(filter.covariance());
  EXPECT_GT(solver.eigenvalues().minCoeff(), -1e-12);
  EXPECT_NEAR(filter.belief().pose.x, 150.0, 0.05);
}

TEST(TrackingFilter, LearnsThatTheWheelsAreLargerThanBelieved) {
  TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
  filter.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(0.04, 0.04, 0.04).asDiagonal()});
  double truth = 0.0;
  for (int i = 1; i <= 2400; ++i) {
    filter.predict({0.02, 0.0, 0.0});
    truth += 0.02 * 1.015;
    if (i % 120 == 0) {
      Fixture fixture;
      fixture.world_from_fixture = {truth, 0.0, 0.0};
      filter.correct(overhead(), i, fixture, 0.3, 0.0, truth);
    }
  }
  EXPECT_NEAR(filter.state()(TrackingFilter::kScale), 0.015, 0.004);
}

TEST(TrackingFilter, ASquareUnderATiltedCameraTurnsByTheMeanOfItsSides) {
  constexpr double kHeight = 2.5;
  const Eigen::Vector2d tilt(0.015, -0.03);
  ErrorParams errors;
  errors.camera_tilt = 0.03;
  TrackingFilter filter(kHeight, {0.0, 0.0}, 0.33, errors);
  filter.start({{-1.5, 0.0, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  Fixture square;
  square.shape = FixtureShape::kSquare;
  square.length = square.width = 0.6;
  square.world_from_fixture = {0.0, 0.9, 0.3};
  for (Pose2 robot{-1.5, 0.0, 0.0}; robot.x < 1.5; robot.x += 0.02) {
    const Pose2 at = robot.inverse() * square.world_from_fixture;
    const auto seen = [&](const Eigen::Vector2d& place) {
      const Eigen::Vector2d p = at * place / kHeight;
      return Eigen::Vector2d(kHeight * (p + tilt) / (1.0 - tilt.dot(p)));
    };
    const Eigen::Vector2d along = seen({0.3, 0.0}) - seen({-0.3, 0.0});
    const Eigen::Vector2d across = seen({0.0, 0.3}) - seen({0.0, -0.3});
    FixtureSighting sighting = overhead();
    sighting.shape = FixtureShape::kSquare;
    sighting.robot_from_fixture = {seen({0.0, 0.0}).x(), seen({0.0, 0.0}).y(),
                                   0.5 * (std::atan2(along.y(), along.x()) + std::atan2(-across.x(), across.y()))};
    filter.correct(sighting, 0, square, 0.0, 0.0, robot.x + 1.5);
    filter.predict({0.02, 0.0, 0.0});
  }
  EXPECT_LT(std::abs(filter.belief().pose.theta), radians(0.3));
}

TEST(TrackingFilter, AStretchSeenForLongTellsNoPlaceAlongItsFixture) {
  TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
  filter.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  FixtureSighting stretch = overhead();
  stretch.clipped = true;
  stretch.near_end_visible = stretch.far_end_visible = false;
  stretch.length = 0.4;
  stretch.robot_from_fixture = {0.4, 0.0, 0.0};  // its near end in fact, of the 1.2 m
  for (int i = 0; i < 30; ++i) {
    filter.correct(stretch, 0, Fixture{}, 0.0, 0.0, 0.0);
  }
  EXPECT_LT(std::abs(filter.belief().pose.x), 2.0 * std::sqrt(filter.belief().covariance(0, 0)));
  EXPECT_LT(filter.belief().covariance(1, 1), 0.002);
}

TEST(TrackingFilter, ADoubtedFixtureTellsWhereItHangsAndNotWhereTheRobotIs) {
  const auto pose_after_fixture_beside_its_place = [](bool is_doubted) {
    TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
    filter.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal()});
    if (is_doubted) {
      filter.doubt(0);
    }
    Fixture fixture;
    fixture.world_from_fixture = {0.4, 0.0, 0.0};  // it hangs above the robot
    filter.correct(overhead(), 0, fixture, 0.0, 0.0, 0.0);
    EXPECT_EQ(filter.offset_of(0).mean.x() < -0.3, is_doubted);
    return filter.belief().pose.x;
  };
  EXPECT_GT(pose_after_fixture_beside_its_place(false), 0.1);
  EXPECT_LT(pose_after_fixture_beside_its_place(true), 0.02);
}

TEST(TrackingFilter, WhatSurprisesIsSharedByPoseAndFixtureAndLearntInTheEnd) {
  TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
  filter.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal()});
  const Eigen::Vector3d surprise{0.0036, 0.0036, 0.0007};
  filter.widen(surprise);
  filter.widen_place(0, surprise);
  Fixture moved;
  moved.world_from_fixture = {0.0, 0.26, 0.0};  // by the file; it hangs above the robot
  filter.correct(overhead(), 0, moved, 0.0, 0.0, 0.0);
  EXPECT_LT(filter.offset_of(0).mean.y(), -0.10);
  for (int pass = 1; pass < 5; ++pass) {
    for (int i = 1; i <= TrackingFilter::kSlots; ++i) {
      filter.correct(overhead(), pass * 10 + i, Fixture{}, 0.0, 0.0, 0.0);
    }
    filter.correct(overhead(), 0, moved, 0.0, 0.0, 0.0);
  }
  EXPECT_NEAR(filter.offset_of(0).mean.y(), -0.26, 0.04);
  EXPECT_NEAR(filter.belief().pose.y, 0.0, 0.03);
}

TEST(TrackingFilter, WhereADoubtedFixtureHangsIsRememberedWhenOthersWereSeen) {
  TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
  filter.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal()});
  filter.doubt(0);
  Fixture moved;
  moved.world_from_fixture = {0.4, 0.0, 0.0};
  filter.correct(overhead(), 0, moved, 0.0, 0.0, 0.0);
  for (int i = 1; i <= TrackingFilter::kSlots; ++i) {
    filter.correct(overhead(), i, Fixture{}, 0.0, 0.0, 0.0);
  }
  EXPECT_NEAR(filter.offset_of(0).mean.x(), -0.4, 0.05);
  EXPECT_LT(filter.offset_of(0).covariance(0, 0), 0.05 * 0.05);
  EXPECT_EQ(filter.offset_of(1 + TrackingFilter::kSlots).mean.norm(), 0.0);
}

TEST(TrackingFilter, OfTwoFiltersBecomesTheOneThatTheNextFixtureFits) {
  for (const double place : {0.0, 0.4}) {  // [m] where the next fixture tells that the robot is
    TrackingFilter hung(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
    hung.start({{0.0, 0.0, 0.0}, Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal()});
    TrackingFilter moved = hung;
    Fixture fixture;
    fixture.world_from_fixture = {0.4, 0.0, 0.0};  // by the file; it is seen overhead
    moved.widen({0.09, 0.09, 0.03});
    moved.correct(overhead(), 0, fixture, 0.0, 0.0, 0.0);
    hung.doubt(0);
    hung.correct(overhead(), 0, fixture, 0.0, 0.0, 0.0);
    hung.mix_in(moved, 0.5);
    EXPECT_NEAR(hung.belief().pose.x, 0.2, 0.03);
    EXPECT_NEAR(std::sqrt(hung.belief().covariance(0, 0)), 0.2, 0.03);
    EXPECT_NEAR(hung.offset_of(0).mean.x(), -0.2, 0.03);
    Fixture next;
    next.world_from_fixture = {place, 0.0, 0.0};
    hung.correct(overhead(), 1, next, 0.0, 0.0, 0.0);
    EXPECT_NEAR(hung.belief().pose.x, place, 0.03);
    EXPECT_NEAR(hung.offset_of(0).mean.x(), place - 0.4, 0.03);
  }
}

/// Deviation of the heading [rad] that begins as 3 degrees, after a drive past a round lamp beside its place; the first
/// images show it `bias` [m] too far ahead.
double heading_sigma_below_a_displaced_lamp(double bias) {
  TrackingFilter filter(2.5, {0.0, 0.0}, 0.33, ErrorParams{});
  filter.start({{-1.0, 0.0, 0.0}, Eigen::Vector3d(0.01, 0.01, radians(3.0) * radians(3.0)).asDiagonal()});
  filter.doubt(0);
  Fixture lamp;
  lamp.shape = FixtureShape::kRound;
  lamp.world_from_fixture = {0.3, 0.5, 0.0};  // by the file; it hangs at (0, 0.2)
  for (int i = 0; i <= 200; ++i) {
    const double x = -1.0 + 0.01 * i;
    FixtureSighting sighting = overhead();
    sighting.robot_from_fixture = {-x + (i < 30 ? bias : 0.0), 0.2, 0.0};
    filter.correct(sighting, 0, lamp, 0.15, 0.0, x);
    filter.predict({0.01, 0.0, 0.0});
  }
  return std::sqrt(filter.belief().covariance(2, 2));
}

TEST(TrackingFilter, ARoundLampBesideItsPlaceTellsNoHeading) {
  EXPECT_GT(heading_sigma_below_a_displaced_lamp(0.0), 0.95 * radians(3.0));
  EXPECT_GT(heading_sigma_below_a_displaced_lamp(0.1), 0.95 * radians(3.0));
}

}  // namespace
}  // namespace luminav
