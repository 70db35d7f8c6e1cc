#include <gtest/gtest.h>

#include "tests/unit/detector/ceiling_picture.hpp"
#include "tests/unit/detector/drawn_detections.hpp"

namespace luminav {
namespace {

using test::DrawnCeiling;
using test::DrawnShape;

constexpr double kHeight = 2.8;

CeilingCatalogue only(const CeilingKind& kind) {
  return {.fixtures = {kind}, .elements = {}, .ceiling_height = kHeight};
}

TEST(Luminaires, FindAnUnlitDownlightWhoseLampIsAsBrightAsTheCeiling) {
  const CeilingKind downlight{
      .shape = FixtureShape::kRound, .length = 0.2, .width = 0.2, .height = kHeight, .lamps = 1};
  DrawnCeiling ceiling;
  DrawnShape disc{.pose = {0.1, 0.05, 0.0}, .shape = FixtureShape::kRound, .length = 0.2, .width = 0.2};
  disc.state = DetectionState::kUnlit;
  disc.darker = 50.0;
  ceiling.shapes = {disc, disc};
  ceiling.shapes[1].length = ceiling.shapes[1].width = 0.09;
  ceiling.shapes[1].darker = 0.0;
  const auto detections = test::detect(ceiling, test::test_camera(), only(downlight));
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_NEAR((detections[0].robot_from_fixture.position() - disc.pose.position()).norm(), 0.0, 5e-3);
}

TEST(Luminaires, FindNarrowUnlitOnesOnlyWhereTheyAreWholeInView) {
  const CeilingKind narrow{.length = 0.8, .width = 0.06, .height = kHeight, .lamps = 1};
  for (const double x : {0.1, 0.95}) {  // in view up to x = 1.08 m
    DrawnCeiling ceiling;
    ceiling.shapes = {{.pose = {x, 0.1, 0.0}, .length = 0.8, .width = 0.06, .state = DetectionState::kUnlit}};
    ceiling.shapes[0].darker = 50.0;
    EXPECT_EQ(test::detect(ceiling, test::test_camera(), only(narrow)).size(), x < 0.5 ? 1U : 0U);
  }
}

TEST(Luminaires, FindABareBattenThatIsAsBrightAsTheCeilingBetweenItsShadows) {
  const CeilingKind batten{.length = 1.2, .width = 0.14, .height = kHeight, .lamps = 2};
  for (const double darker : {12.0, 50.0}) {  // a shadow, and the dark inside of an open girder
    DrawnCeiling ceiling;
    const Pose2 pose{0.1, 0.1, 0.3};
    ceiling.shapes = {{.pose = pose, .length = 1.26, .width = 0.20, .state = DetectionState::kUnlit},
                      {.pose = pose, .length = 1.2, .width = 0.14, .state = DetectionState::kUnlit}};
    ceiling.shapes[0].darker = darker;
    ceiling.shapes[1].darker = 0.0;
    const auto detections = test::detect(ceiling, test::test_camera(), only(batten));
    ASSERT_EQ(detections.size(), darker < 20.0 ? 1U : 0U);
    if (!detections.empty()) {
      EXPECT_EQ(detections[0].state, DetectionState::kUnlit);
      test::expect_at(detections[0], pose, 5e-3, radians(0.4));
    }
  }
}

TEST(Luminaires, FindUnlitOnesThatAreLongerThanTheFileSays) {
  const CeilingKind told{.length = 1.08, .width = 0.135, .height = kHeight, .lamps = 1};
  DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {0.1, 0.1, 0.3}, .length = 1.2, .width = 0.15, .state = DetectionState::kUnlit}};
  const auto detections = test::detect(ceiling, test::test_camera(), only(told));
  ASSERT_EQ(detections.size(), 1U);
  test::expect_at(detections[0], ceiling.shapes[0].pose, 5e-3, radians(0.4));
}

TEST(Luminaires, FindUnlitOnesInADimPicture) {
  const CeilingKind lamp{.length = 1.2, .width = 0.3, .height = kHeight, .lamps = 2};
  DrawnCeiling ceiling{.grey = 30.0, .noise = 3.0};
  ceiling.shapes = {{.pose = {0.1, 0.1, 0.3}, .length = 1.2, .width = 0.3, .state = DetectionState::kUnlit}};
  ceiling.shapes[0].darker = 3.5;
  const auto detections = test::detect(ceiling, test::test_camera(), only(lamp));
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].state, DetectionState::kUnlit);
  test::expect_at(detections[0], ceiling.shapes[0].pose, 10e-3, radians(0.5));
}

TEST(Luminaires, FindEachOfARowEndToEnd) {
  const CeilingKind lamp{.length = 1.0, .width = 0.15, .height = kHeight, .lamps = 1};
  DrawnCeiling ceiling;
  for (const double x : {-1.04, 0.0, 1.04}) {  // in view up to 1.08 m
    ceiling.shapes.push_back({.pose = {x, 0.1, 0.0}, .length = 1.0, .width = 0.15});
  }
  ceiling.bloom = 20.0;
  const auto detections = test::detect(ceiling, test::test_camera(), only(lamp));
  ASSERT_EQ(detections.size(), 3U);
  test::expect_at(detections[0], {0.0, 0.1, 0.0}, 5e-3, radians(0.2));
}

TEST(Luminaires, FindASquareOneOfWhichTwoOfThreeTubesBurn) {
  const CeilingKind louvre{.shape = FixtureShape::kSquare, .length = 0.6, .width = 0.6, .height = kHeight, .lamps = 3};
  DrawnCeiling ceiling;
  DrawnShape square{.pose = {0.1, 0.05, 0.0}, .shape = FixtureShape::kSquare, .length = 0.6, .width = 0.6};
  square.state = DetectionState::kUnlit;
  square.darker = 70.0;
  ceiling.shapes = {square, {.pose = {0.1, 0.15, 0.0}, .length = 0.6, .width = 0.4}};
  const auto detections = test::detect(ceiling, test::test_camera(), only(louvre));
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].state, DetectionState::kHalf);
  EXPECT_EQ(detections[0].shape, FixtureShape::kSquare);
  EXPECT_NEAR((detections[0].robot_from_fixture.position() - square.pose.position()).norm(), 0.0, 0.01);
}

}  // namespace
}  // namespace luminav
