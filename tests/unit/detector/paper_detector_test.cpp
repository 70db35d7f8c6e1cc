#include <gtest/gtest.h>

#include "services/detector/detector.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

using test::DrawnCeiling;

DetectorParams paper() {
  DetectorParams params;
  params.mode = DetectorMode::kPaper;
  return params;
}

std::vector<Detection> detect(const DrawnCeiling& ceiling, const DetectorParams& params = paper()) {
  const CameraDescription camera = test::test_camera();
  Detector detector(params, camera, test::test_catalogue());
  return detector.detect(test::draw_ceiling(ceiling, camera, 2.8).view());
}

TEST(PaperDetector, FindsLitFixturesOfOneAndOfTwoLamps) {
  for (const double width : {0.15, 0.30}) {
    DrawnCeiling ceiling;
    ceiling.bloom = 0.0;
    const Pose2 truth{0.1, -0.2, 0.8};
    ceiling.shapes = {{.pose = truth, .width = width}};
    const auto detections = detect(ceiling);
    ASSERT_EQ(detections.size(), 1U);
    EXPECT_EQ(detections[0].state, DetectionState::kLit);
    EXPECT_NEAR(detections[0].robot_from_fixture.x, truth.x, 5e-3);
    EXPECT_NEAR(detections[0].robot_from_fixture.y, truth.y, 5e-3);
    EXPECT_NEAR(wrap_axis(detections[0].robot_from_fixture.theta - truth.theta), 0.0, radians(0.5));
  }
}

TEST(PaperDetector, FindsUnlitFixturesByTheSecondThreshold) {
  DrawnCeiling ceiling;
  ceiling.noise = 2.0;
  ceiling.shapes = {{.pose = {0.0, 0.0, 0.3}, .state = DetectionState::kUnlit, .darker = 40.0}};
  const auto detections = detect(ceiling);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].state, DetectionState::kUnlit);
}

TEST(PaperDetector, CallsAFixtureHalfLitWhenBothThresholdsFiredInIt) {
  DrawnCeiling ceiling;
  ceiling.noise = 2.0;
  ceiling.shapes = {{.pose = {0.0, 0.0, 0.3}, .state = DetectionState::kHalf, .darker = 50.0}};
  const auto detections = detect(ceiling);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].state, DetectionState::kHalf);
}

TEST(PaperDetector, FindsALampWhoseSurroundingsAreBelowTheSecondThreshold) {
  DrawnCeiling ceiling;
  ceiling.noise = 2.0;
  ceiling.bloom = 0.0;
  ceiling.grey = 130.0;
  ceiling.slope_y = -400.0;  // so that a part of the ceiling is as dark as an unlit fixture
  ceiling.shapes = {{.pose = {0.0, 0.3, 0.0}}};
  const auto detections = detect(ceiling);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].state, DetectionState::kLit);
  EXPECT_NEAR(detections[0].robot_from_fixture.y, 0.3, 0.01);
}

TEST(PaperDetector, RefusesOtherSizes) {
  for (const auto& [length, width] : {std::pair{0.6, 0.3}, {1.2, 0.6}, {1.8, 0.3}, {0.3, 0.3}}) {
    DrawnCeiling ceiling;
    ceiling.shapes = {{.pose = {0.0, 0.0, 0.3}, .length = length, .width = width}};
    EXPECT_TRUE(detect(ceiling).empty()) << length << " x " << width;
  }
}

TEST(PaperDetector, ContoursThroughCannyFindTheSameFixture) {
  DrawnCeiling ceiling;
  ceiling.bloom = 0.0;
  ceiling.shapes = {{.pose = {0.1, -0.2, 0.8}}};
  DetectorParams canny = paper();
  canny.paper.direct_contours = false;
  const auto direct = detect(ceiling);
  const auto edges = detect(ceiling, canny);
  ASSERT_EQ(direct.size(), 1U);
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_NEAR(direct[0].robot_from_fixture.x, edges[0].robot_from_fixture.x, 4e-3);
}

TEST(PaperDetector, LeavesOutWhatTheBorderCutsUnlessAsked) {
  DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {0.55, 0.1, 0.1}}};
  EXPECT_TRUE(detect(ceiling).empty());
  DetectorParams params = paper();
  params.paper.accept_cut = true;
  const auto detections = detect(ceiling, params);
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_TRUE(detections[0].clipped);
}

}  // namespace
}  // namespace luminav
