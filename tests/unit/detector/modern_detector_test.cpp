#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "services/detector/detector.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"
#include "tests/unit/detector/drawn_detections.hpp"

namespace luminav {
namespace {

using test::detect;
using test::DrawnCeiling;
using test::DrawnShape;
using test::expect_at;

struct Look {
  DetectionState state;
  double width;
};

class ModernDetectorLooks : public testing::TestWithParam<Look> {};

TEST_P(ModernDetectorLooks, FindsAWholeFixtureWithItsStateAtAnyPoseBetweenTiles) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> offset(-0.3, 0.3);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  for (std::uint32_t i = 0; i < 6; ++i) {
    DrawnCeiling ceiling;
    ceiling.seed = i;
    ceiling.joint_depth = i % 2 == 0 ? 0.0 : 20.0;
    ceiling.slope_x = 8.0;
    const Pose2 truth{offset(rng), offset(rng), angle(rng)};
    ceiling.shapes = {{.pose = truth, .width = GetParam().width, .state = GetParam().state, .darker = 22.0}};
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U) << "picture " << i;
    EXPECT_EQ(detections[0].state, GetParam().state);
    EXPECT_EQ(detections[0].shape, FixtureShape::kRectangle);
    EXPECT_FALSE(detections[0].clipped);
    // a joint of 12 mm beside an unlit fixture cannot always be told from it
    const bool ambiguous = GetParam().state == DetectionState::kUnlit && ceiling.joint_depth > 0.0;
    const double position = ambiguous ? 18e-3 : GetParam().state == DetectionState::kHalf ? 4e-3 : 1.5e-3;
    expect_at(detections[0], truth, position, radians(0.1));
  }
}

INSTANTIATE_TEST_SUITE_P(States, ModernDetectorLooks,
                         testing::Values(Look{DetectionState::kLit, 0.30}, Look{DetectionState::kLit, 0.15},
                                         Look{DetectionState::kUnlit, 0.30}, Look{DetectionState::kUnlit, 0.15},
                                         Look{DetectionState::kHalf, 0.30}));

TEST(ModernDetector, FindsADarkHalfAsBrightAsTheCeilingByTheJointsThatItCovers) {
  for (const double theta : {0.0, 0.01, 0.5 * kPi}) {  // along the tiles, as fixtures hang
    DrawnCeiling ceiling;
    ceiling.joint_depth = 20.0;
    const Pose2 truth{0.05, 0.1, theta};
    ceiling.shapes = {{.pose = truth, .state = DetectionState::kHalf, .darker = 0.0}};
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U) << theta;
    EXPECT_EQ(detections[0].state, DetectionState::kHalf) << theta;
    expect_at(detections[0], truth, 4e-3, radians(0.1));
  }
}

TEST(ModernDetector, TakesNoVentForAFixtureWholeOrCut) {
  for (const double x : {0.1, 0.95, 1.05}) {
    DrawnCeiling ceiling;
    ceiling.shapes = {
        {.pose = {x, 0.1, 0.1}, .length = 0.6, .width = 0.3, .state = DetectionState::kUnlit, .darker = 40.0}};
    EXPECT_TRUE(detect(ceiling).empty()) << "vent at x = " << x;
  }
}

TEST(ModernDetector, FindsALampWhoseBloomIsOverexposed) {
  for (const double width : {0.15, 0.30}) {
    DrawnCeiling ceiling;
    const Pose2 truth{0.1, -0.05, 0.6};
    ceiling.grey = 140.0;
    ceiling.bloom = 160.0;  // saturated beyond the lamp's own edge
    ceiling.bloom_reach = 0.035;
    ceiling.shapes = {{.pose = truth, .width = width}};
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U) << "width " << width;
    EXPECT_EQ(detections[0].state, DetectionState::kLit);
    expect_at(detections[0], truth, 2e-3, radians(0.1));
  }
}

TEST(ModernDetector, PlacesATubeByItsSharpSideWhereTheOtherDrownsInGlow) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.length = 1.2, .width = 0.06, .height = 2.8, .lamps = 1}};
  for (const double side : {1.0, -1.0}) {  // on which it glows
    for (const double theta : {0.6, 1.7}) {
      const Pose2 truth{0.1, -0.05, theta};
      DrawnCeiling ceiling;
      ceiling.grey = 40.0;
      ceiling.bloom = 20.0;
      ceiling.shapes = {{.pose = truth, .width = 0.06}};
      for (const auto& [length, width] : {std::pair{1.1, 0.14}, {0.9, 0.18}, {0.6, 0.22}}) {
        ceiling.shapes.push_back(
            {.pose = truth * Pose2{0.0, 0.5 * side * width, 0.0}, .length = length, .width = width});
      }
      const auto detections = detect(ceiling, test::test_camera(), catalogue);
      ASSERT_EQ(detections.size(), 1U) << "side " << side << ", theta " << theta;
      expect_at(detections[0], truth, 0.015, radians(0.3));
    }
  }
}

TEST(ModernDetector, FindsAFaintUnlitFixtureInANoisyPicture) {
  DrawnCeiling ceiling;
  const Pose2 truth{0.1, -0.05, 0.6};
  ceiling.noise = 10.0;
  ceiling.shapes = {{.pose = truth, .state = DetectionState::kUnlit, .darker = 11.0}};
  const auto detections = detect(ceiling);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].state, DetectionState::kUnlit);
  expect_at(detections[0], truth, 5e-3, radians(0.2));
}

TEST(ModernDetector, FindsNarrowUnlitFixturesWhoseShortEndsDrownInNoise) {
  int found = 0;
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    DrawnCeiling ceiling;
    const Pose2 truth{0.1, -0.05, 0.2 * seed};
    ceiling.seed = seed;
    ceiling.noise = 13.0;
    ceiling.shapes = {{.pose = truth, .width = 0.15, .state = DetectionState::kUnlit, .darker = 13.0}};
    for (const Detection& detection : detect(ceiling)) {
      ++found;
      expect_at(detection, truth, 12e-3, radians(0.4));
    }
  }
  EXPECT_GE(found, 14);
}

TEST(ModernDetector, FindsAnUnlitFixtureBetweenFainterShadowsOnBothSides) {
  DrawnCeiling ceiling;
  const Pose2 truth{0.1, 0.05, 0.3};
  const auto shadow = [&](double x, double y) {
    ceiling.shapes.push_back({.pose = truth * Pose2{x, y, 0.0},
                              .length = 0.5,
                              .width = 0.16,
                              .state = DetectionState::kUnlit,
                              .darker = 20.0});
  };
  shadow(0.32, 0.22);
  shadow(-0.32, -0.22);
  ceiling.shapes.push_back({.pose = truth, .state = DetectionState::kUnlit, .darker = 30.0});
  const auto detections = detect(ceiling);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].shape, FixtureShape::kRectangle);
  expect_at(detections[0], truth, 8e-3, radians(0.3));
}

TEST(ModernDetector, TellsAPanelThatIsOffFromAVentOfItsSize) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.shape = FixtureShape::kSquare, .length = 0.6, .width = 0.6, .height = 2.8, .lamps = 1}};
  catalogue.elements = {
      {.shape = FixtureShape::kSquare, .length = 0.6, .width = 0.6, .height = 2.8, .lamps = 0, .slatted = true}};
  for (const Pose2& pose : {Pose2{0.1, 0.1, 0.5}, Pose2{-0.2, 0.4, 0.0}, Pose2{0.95, -0.3, 0.05}}) {  // the last is cut
    DrawnCeiling ceiling;
    ceiling.shapes = {
        {.pose = pose, .length = 0.6, .width = 0.6, .state = DetectionState::kUnlit, .darker = 40.0, .slats = 25.0}};
    EXPECT_TRUE(detect(ceiling, test::test_camera(), catalogue).empty()) << pose.x;
    ceiling.shapes[0].slats = 0.0;
    EXPECT_EQ(detect(ceiling, test::test_camera(), catalogue).size(), 1U) << pose.x;
  }
}

TEST(ModernDetector, TakesNoDarkSpeckForASmallRoundFixture) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.fixtures = {{.shape = FixtureShape::kRound, .length = 0.06, .width = 0.06, .height = 2.8, .lamps = 1}};
  DrawnCeiling ceiling;
  DrawnShape speck{.pose = {0.1, 0.1, 0.0}, .shape = FixtureShape::kRound, .length = 0.06, .width = 0.06};
  ceiling.shapes = {speck};
  EXPECT_EQ(detect(ceiling, test::test_camera(), catalogue).size(), 1U);
  ceiling.shapes[0].state = DetectionState::kUnlit;
  catalogue.elements.clear();
  EXPECT_TRUE(detect(ceiling, test::test_camera(), catalogue).empty());
}

TEST(ModernDetector, SeesNoFixtureInShapesOfOtherSizes) {
  const std::vector<DrawnShape> strangers{
      {.pose = {0.1, 0.1, 0.5}, .length = 0.8, .width = 0.3},                                   // a bright window
      {.pose = {0.1, 0.1, 0.5}, .length = 1.2, .width = 0.6},                                   //
      {.pose = {0.0, 0.0, 1.0}, .shape = FixtureShape::kRound, .length = 0.4, .width = 0.4},    // a reflection
      {.pose = {0.0, 0.0, 0.0}, .length = 0.6, .width = 0.6, .state = DetectionState::kUnlit},  // a tile
      {.pose = {0.9, 0.3, 0.3},
       .shape = FixtureShape::kRound,
       .length = 0.5,
       .width = 0.5,
       .state = DetectionState::kUnlit,
       .darker = 60.0}};  // a head leaning in
  for (std::size_t i = 0; i < strangers.size(); ++i) {
    DrawnCeiling ceiling;
    ceiling.joint_depth = 15.0;
    ceiling.shapes = {strangers[i]};
    EXPECT_TRUE(detect(ceiling).empty()) << "stranger " << i;
  }
}

TEST(ModernDetector, SeesNothingOnAnEmptyCeilingBlackWhiteOrTiled) {
  for (const double grey : {0.0, 60.0, 110.0, 255.0}) {
    DrawnCeiling ceiling;
    ceiling.grey = grey;
    ceiling.joint_depth = 26.0;
    ceiling.slope_y = 25.0;
    EXPECT_TRUE(detect(ceiling).empty()) << "grey " << grey;
  }
}

TEST(ModernDetector, CoversItsErrorsByItsCovariance) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> offset(-0.9, 0.9);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  double sum = 0.0;
  int count = 0;
  for (std::uint32_t i = 0; i < 24; ++i) {
    DrawnCeiling ceiling;
    ceiling.seed = i;
    const Pose2 truth{offset(rng), offset(rng), angle(rng)};
    ceiling.shapes = {{.pose = truth, .state = i % 2 == 0 ? DetectionState::kLit : DetectionState::kUnlit}};
    for (const Detection& detection : detect(ceiling)) {
      const Eigen::Vector3d error(detection.robot_from_fixture.x - truth.x, detection.robot_from_fixture.y - truth.y,
                                  wrap_axis(detection.robot_from_fixture.theta - truth.theta));
      const double squared = error.dot(detection.covariance.inverse() * error);
      EXPECT_LT(squared, 20.0) << "picture " << i;  // chi2(3) at 99.98 %
      sum += squared;
      ++count;
    }
  }
  ASSERT_GE(count, 18);
  EXPECT_LT(sum / (3 * count), 1.5);
}

TEST(Detector, TakesImagesOfAnotherSizeWhenTheAspectFits) {
  CameraDescription camera = test::test_camera();
  const Pose2 truth{0.1, 0.0, 0.7};
  DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = truth}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, 2.8);
  CameraDescription other = camera;  // the same lens, calibrated at twice the size
  other.intrinsics.width = 1280;
  other.intrinsics.height = 960;
  other.intrinsics.fx *= 2.0;
  other.intrinsics.fy *= 2.0;
  other.intrinsics.cx = 2.0 * (camera.intrinsics.cx + 0.5) - 0.5;
  other.intrinsics.cy = 2.0 * (camera.intrinsics.cy + 0.5) - 0.5;
  Detector detector({}, other, test::test_catalogue());
  const auto detections = detector.detect(image.view());
  ASSERT_EQ(detections.size(), 1U);
  expect_at(detections[0], truth, 1e-3, radians(0.05));
}

TEST(Detector, RefusesImagesThatAreNotWholeOrOfAnotherAspect) {
  Detector detector({}, test::test_camera(), test::test_catalogue());
  const std::vector<std::uint8_t> pixels(640 * 480, 90);
  EXPECT_TRUE(detector.accepts({640, 480, pixels}));
  EXPECT_FALSE(detector.accepts({640, 481, pixels}));
  EXPECT_FALSE(detector.accepts({480, 640, pixels}));
  EXPECT_FALSE(detector.accepts({0, 0, {}}));
  EXPECT_FALSE(detector.accepts({-640, -480, pixels}));
  EXPECT_TRUE(detector.detect({480, 640, pixels}).empty());
}

TEST(Detector, RefusesACeilingBelowTheCamera) {
  CeilingCatalogue catalogue = test::test_catalogue();
  catalogue.ceiling_height = 0.2;
  EXPECT_THROW(Detector({}, test::test_camera(), catalogue), std::invalid_argument);
}

}  // namespace
}  // namespace luminav
