#include "services/localizer/calibration/drive_residuals.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(DriveResiduals, WrapModuloAPeriod) {
  EXPECT_NEAR(wrapped_residual(3.5 * kPi, 2.0 * kPi), -0.5 * kPi, 1e-12);
  EXPECT_NEAR(wrapped_residual(-0.9 * kPi, kPi), 0.1 * kPi, 1e-12);
}

TEST(DriveResiduals, WhitenWhatHasTheCovariance) {
  Eigen::Matrix3d covariance;
  covariance << 4.0, 1.0, 0.5, 1.0, 2.0, 0.2, 0.5, 0.2, 1.0;
  const Eigen::Matrix3d weight = whitening(covariance);
  EXPECT_NEAR((weight * covariance * weight.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-9);
}

TEST(DriveResiduals, AreZeroForAMotionThatTheWheelsTold) {
  const OdometryResidual residual{{{0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}}, 0.33, Eigen::Matrix3d::Identity()};
  const double from[3] = {1.0, 2.0, 0.5 * kPi};
  const double to[3] = {1.0, 3.0, 0.5 * kPi};
  const double wheels[3] = {0.0, 0.0, 0.0};
  double error[3] = {};
  residual(from, to, wheels, error);
  EXPECT_NEAR(std::hypot(error[0], error[1], error[2]), 0.0, 1e-12);
  const double larger[3] = {0.1, 0.0, 0.0};
  residual(from, to, larger, error);
  EXPECT_NEAR(error[0], -0.1 / 1.1, 1e-12);
}

TEST(DriveResiduals, AreAsLargeInASmallerMap) {
  const OdometryResidual residual{{{1.0, 0.0, 0.0}}, 0.33, Eigen::Matrix3d::Identity()};
  for (const double scale : {0.0, -0.05, 0.05}) {
    const double from[3] = {0.0, 0.0, 0.0};
    const double to[3] = {1.02 * (1.0 + scale), 0.03 * (1.0 + scale), 0.0};
    const double wheels[3] = {scale, 0.0, 0.0};
    double error[3] = {};
    residual(from, to, wheels, error);
    EXPECT_NEAR(error[0], 0.02, 1e-12);
    EXPECT_NEAR(error[1], 0.03, 1e-12);
  }
}

TEST(DriveResiduals, SeeAFixtureWhereItHangsAndLongerFromNearer) {
  SightingResidual residual{
      {1.0, 0.0, 0.0}, {}, Eigen::Matrix3d::Identity(), {0.0, 0.0}, 2.5, 0.0, 0.0, kPi, 1.2, 1.2, 1.0};
  const double pose[3] = {2.0, 1.0, 0.0};
  const double fixture[3] = {3.0, 1.0, kPi};  // half a turn changes nothing
  double camera[6] = {};
  double error[4] = {};
  residual(pose, fixture, camera, error);
  EXPECT_NEAR(std::hypot(error[0], error[1], error[2]) + std::abs(error[3]), 0.0, 1e-12);
  camera[3] = 0.01;  // the picture is larger
  residual(pose, fixture, camera, error);
  EXPECT_NEAR(error[0], -0.01, 1e-12);
  EXPECT_NEAR(error[3], -0.012, 1e-12);
}

TEST(DriveResiduals, TurnASquareUnderATiltedCameraByTheMeanOfItsSides) {
  constexpr double kHeight = 2.5;
  const Eigen::Vector2d tilt(0.015, -0.03);
  const Pose2 square{1.2, 0.9, 0.3};
  const auto seen = [&](const Eigen::Vector2d& place) {  // through a camera that is turned, exactly
    const Eigen::Vector2d p = square * place / kHeight;
    return Eigen::Vector2d(kHeight * (p + tilt) / (1.0 - tilt.dot(p)));
  };
  const Eigen::Vector2d along = seen({0.3, 0.0}) - seen({-0.3, 0.0});
  const Eigen::Vector2d across = seen({0.0, 0.3}) - seen({0.0, -0.3});
  const double theta = 0.5 * (std::atan2(along.y(), along.x()) + std::atan2(-across.x(), across.y()));
  const Eigen::Vector2d centre = seen({0.0, 0.0});
  SightingResidual residual{{centre.x(), centre.y(), theta},
                            {},
                            Eigen::Matrix3d::Identity(),
                            {0.0, 0.0},
                            kHeight,
                            0.0,
                            0.0,
                            0.5 * kPi,
                            0.6,
                            0.6};
  residual.is_square = true;
  const double pose[3] = {0.0, 0.0, 0.0};
  const double fixture[3] = {square.x, square.y, square.theta};
  const double camera[6] = {tilt.x(), tilt.y(), 0.0, 0.0, 0.0, 0.0};
  double error[4] = {};
  residual(pose, fixture, camera, error);
  EXPECT_LT(std::abs(error[2]), radians(0.05));
  residual.is_square = false;
  residual(pose, fixture, camera, error);
  EXPECT_GT(std::abs(error[2]), radians(0.3)) << "the long side of a bar turns otherwise";
}

TEST(DriveResiduals, TrustOdometryLessTheFartherItGoes) {
  const std::vector<Pose2> one = {{0.1, 0.0, 0.0}};
  const std::vector<Pose2> ten(10, Pose2{0.1, 0.0, 0.0});
  EXPECT_GT(noise_of_steps(ten, 0.33, {})(0, 0), 9.0 * noise_of_steps(one, 0.33, {})(0, 0));
  EXPECT_GT(noise_of_steps(ten, 0.33, {})(2, 2), 9.0 * noise_of_steps(one, 0.33, {})(2, 2));
}

TEST(DriveResiduals, KnowNoHeadingOfARoundFixture) {
  Fixture round;
  round.shape = FixtureShape::kRound;
  FixtureSighting sighting;
  sighting.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  EXPECT_GT(noise_of_sighting(sighting, round, 2.5, {})(2, 2), 100.0);
  EXPECT_LT(noise_of_sighting(sighting, Fixture{}, 2.5, {})(2, 2), 1e-3);
}

}  // namespace
}  // namespace luminav
