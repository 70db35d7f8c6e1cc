#include "services/detector/covered_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/detector/unlit_joints.hpp"
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

/// Where the profiles of both ends, or both long sides, place a faint fixture that lies `off` [m] ahead, or to the
/// left, of where it was thought to be.
std::optional<PlaceBetween> place_of_faint_fixture(Side side, double off, std::uint32_t seed) {
  constexpr double kHeight = 2.8;  // [m]
  const CameraDescription description = test::test_camera();
  const bool end = side == kFarEnd;
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {end ? off : 0.0, end ? 0.0 : off, 0.0}, .state = DetectionState::kUnlit, .darker = 8.0}};
  ceiling.noise = 6.0;
  ceiling.seed = seed;
  const GreyImage image = test::draw_ceiling(ceiling, description, kHeight);
  const CeilingCamera camera(description.intrinsics, description.mounting);
  const Eigen::Vector2d x = Eigen::Vector2d::UnitX();
  const Eigen::Vector2d y = Eigen::Vector2d::UnitY();
  const auto costs = [&](double sign) {
    const SideLine line{.pose = {},
                        .height = kHeight,
                        .along = end ? y : x,
                        .out = sign * (end ? x : y),
                        .half_length = end ? 0.15 : 0.6,
                        .distance = end ? 0.6 : 0.15};
    return end_costs(image.view(), camera, line, 0.004, ceiling.noise, std::nullopt);
  };
  const auto positive = costs(1.0);
  const auto negative = costs(-1.0);
  return positive && negative ? place_between(*positive, *negative, end ? 0.6 : 0.15) : std::nullopt;
}

TEST(CoveredJoints, PlaceAFaintFixtureByTheGreyLevelsOfItsWholeEnds) {
  constexpr int kPictures = 20;
  double squares = 0.0;
  double normalised = 0.0;
  for (int i = 0; i < kPictures; ++i) {
    const double off = -0.009 + 0.001 * i;
    const auto place = place_of_faint_fixture(kFarEnd, off, static_cast<std::uint32_t>(i + 1));
    ASSERT_TRUE(place) << off;
    squares += std::pow(place->shift - off, 2);
    normalised += std::pow(place->shift - off, 2) / place->variance;
  }
  EXPECT_LT(std::sqrt(squares / kPictures), 0.9e-3) << "a fifth of a pixel, with a step of 1.3 sigmas of noise";
  EXPECT_LT(normalised / kPictures, 1.7);  // chi squared of 20 values exceeds it once in 36 times
}

TEST(CoveredJoints, PlaceAFaintFixtureByAllPixelsAlongItsSides) {
  constexpr int kPictures = 20;
  double squares = 0.0;
  for (int i = 0; i < kPictures; ++i) {
    const double off = -0.009 + 0.001 * i;
    const auto place = place_of_faint_fixture(kLeftSide, off, static_cast<std::uint32_t>(i + 1));
    ASSERT_TRUE(place) << off;
    squares += std::pow(place->shift - off, 2);
  }
  EXPECT_LT(std::sqrt(squares / kPictures), 0.4e-3) << "a twelfth of a pixel";
}

TEST(CoveredJoints, PlaceAFixtureByItsEndInAJointWhereTheOtherIsAtTheBorder) {
  constexpr double kHeight = 2.8;  // [m]
  CameraDescription description = test::test_camera();
  description.mounting.y = 0.1;  // so that the border is 1.42 m to the right ...
  const CeilingCamera camera(description.intrinsics, description.mounting);
  const Pose2 truth{0.10, -0.81, 0.5 * kPi};  // ... and the fixture's left end at the joint 0.21 m to the right
  test::DrawnCeiling ceiling;
  ceiling.joint_depth = 25.0;
  ceiling.shapes = {{.pose = truth, .state = DetectionState::kUnlit, .darker = 18.0}};
  const GreyImage image = test::draw_ceiling(ceiling, description, kHeight);
  for (const double off : {-0.006, 0.006}) {  // [m] as by the joint's far edge
    OutlineFit fit;
    fit.robot_from_outline = truth * Pose2{off, 0.0, 0.0};
    fit.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    fit.expected.fill(10);
    fit.in_view.fill(10);
    fit.metres_per_px = 0.0046;
    fit.step = 18.0;
    take_off_joints(image.view(), camera, {.length = 1.2, .width = 0.3, .height = kHeight}, {.inside_brighter = false},
                    fit);
    EXPECT_NEAR(fit.robot_from_outline.y, truth.y, 2e-3) << "started " << off;
    EXPECT_LT(std::sqrt(fit.covariance(0, 0)), 3e-3);
  }
}

TEST(CoveredJoints, PlaceALoneEndWhereItsCostsAreLeast) {
  const auto place = place_of(costs_around(6.0, 4.0), 0.6);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->shift, 6.0 * EndCosts::kStep, 1e-6);
  const double size_error = 0.0009;  // [m] 0.3 mm and a thousandth of half the size
  EXPECT_NEAR(std::sqrt(place->variance), std::hypot(4.0 * EndCosts::kStep, size_error), 0.05 * EndCosts::kStep);
}

TEST(CoveredJoints, LeaveOpenWhichOfTwoBlursIsRight) {
  EndCosts costs = costs_around(-6.0, 2.0);
  costs.cost[1] = costs_around(6.0, 2.0).cost[1];  // as likely, at another place
  for (std::size_t blur = 2; blur < EndCosts::kBlurs; ++blur) {
    costs.cost[blur].fill(100.0);
  }
  const auto place = place_of(costs, 0.0);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->shift, 0.0, 0.1 * EndCosts::kStep);
  EXPECT_GT(std::sqrt(place->variance), 6.0 * EndCosts::kStep);
}

TEST(CoveredJoints, TakeTheBlurThatOtherSidesShow) {
  EndCosts costs = costs_around(-6.0, 2.0);
  costs.cost[1] = costs_around(6.0, 2.0).cost[1];  // as likely, at another place
  EndCosts other = costs_around(0.0, 2.0);
  for (std::size_t blur = 0; blur < EndCosts::kBlurs; ++blur) {
    costs.cost[blur][0] += 100.0 * static_cast<double>(blur > 1);
    for (double& cost : other.cost[blur]) {
      cost += blur == 1 ? 0.0 : 100.0;
    }
  }
  BlurCosts blurs{};
  learn_blur(other, blurs);
  const auto place = place_of(costs, 0.0, blurs);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->shift, 6.0 * EndCosts::kStep, 0.2 * EndCosts::kStep);
  EXPECT_LT(std::sqrt(place->variance), 2.5 * EndCosts::kStep);
}

/// The joint found along the end of a fixture that is turned by `askew` [rad] in a grid of 0.6 m, the light changing
/// along it. The end's middle is `outside` [m] beyond the joint.
std::optional<CeilingJoint> joint_along_end(double askew, double outside) {
  constexpr double kHeight = 2.8;  // [m]
  test::DrawnCeiling ceiling;
  ceiling.joint_depth = 25.0;
  ceiling.slope_y = 60.0;
  const CameraDescription description = test::test_camera();
  const GreyImage image = test::draw_ceiling(ceiling, description, kHeight);
  const CeilingCamera camera(description.intrinsics, description.mounting);
  const SideLine end{.pose = {-0.13 + outside, 0.09, askew},
                     .height = kHeight,
                     .along = {0.0, 1.0},
                     .out = {1.0, 0.0},
                     .half_length = 0.1,
                     .distance = 0.0};
  return fit_ceiling_joint(image.view(), camera, end, 0.002 - outside, 0.0046);
}

TEST(CoveredJoints, FindAJointBetweenWhereItShowsBeyondBothCorners) {
  for (const double askew : {0.0, radians(0.5), -radians(0.5)}) {
    const auto joint = joint_along_end(askew, 0.004);
    ASSERT_TRUE(joint);
    EXPECT_NEAR(joint->middle, -0.004, 0.4e-3) << askew;
  }
}

/// Where a fixture is placed that hangs at the middle of the picture and is little brighter than the joints, the lens
/// blurring both: one joint `outside` [m] of its far end, the other as far inside of its near one. No noise.
std::optional<PlaceBetween> place_between_soft_joints(double outside) {
  constexpr double kHeight = 2.8;  // [m]
  const CameraDescription description = test::test_camera();
  const CeilingCamera camera(description.intrinsics, description.mounting);
  const auto beyond = [](double distance, double sigma) {
    return 0.5 * std::erfc(-distance / (std::sqrt(2.0) * sigma));
  };
  GreyImage image = test::draw_ceiling({}, description, kHeight);
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const auto point = camera.point_on_ceiling({1.0 * column, 1.0 * row}, kHeight);
      const double along = std::remainder(point->x() - outside - 0.6, 0.6);
      const double joint = beyond(along + 0.007, 0.0032) - beyond(along - 0.007, 0.0032);
      const double covered = beyond(0.6 - std::abs(point->x()), 0.0041) * beyond(0.15 - std::abs(point->y()), 0.0041);
      const double grey = 110.0 * (covered * 0.8 + (1.0 - covered) * (1.0 - 0.26 * joint));
      image.pixels[static_cast<std::size_t>(row * image.width + column)] = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
  const auto costs = [&](double sign) {
    const SideLine end{
        .pose = {}, .height = kHeight, .along = {0.0, 1.0}, .out = {sign, 0.0}, .half_length = 0.15, .distance = 0.6};
    const auto joint = fit_ceiling_joint(image.view(), camera, end, sign * outside, 0.0046);
    return end_costs(image.view(), camera, end, 0.0046, 4.0, joint);
  };
  const auto far = costs(1.0);
  const auto near = costs(-1.0);
  const SideLine left{
      .pose = {}, .height = kHeight, .along = {1.0, 0.0}, .out = {0.0, 1.0}, .half_length = 0.6, .distance = 0.15};
  const auto side = end_costs(image.view(), camera, left, 0.0046, 4.0, std::nullopt);
  BlurCosts blurs{};
  learn_blur(side.value_or(EndCosts{}), blurs);
  return far && near ? place_between(*far, *near, 0.6, blurs) : std::nullopt;
}

TEST(CoveredJoints, PlaceAFixtureBetweenJointsThatTheLensBlurs) {
  for (const double outside : {-0.007, 0.005, 0.007}) {
    const auto place = place_between_soft_joints(outside);
    ASSERT_TRUE(place) << outside;
    EXPECT_NEAR(place->shift, 0.0, 1e-3) << outside;
  }
}

TEST(CoveredJoints, SayNothingWhenTheBorderOfTheSearchIsBest) {
  for (const double beyond : {-45.0, 45.0}) {
    EXPECT_FALSE(place_of(costs_around(beyond, 2.0), 0.6));
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
