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
