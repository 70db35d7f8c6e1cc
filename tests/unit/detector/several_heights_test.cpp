// A hall of 4 m in a school of 3 m.

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "services/detector/detector.hpp"
#include "tests/unit/detector/drawn_detections.hpp"

namespace luminav {
namespace {

constexpr double kRoom = 3.0;  // [m]
constexpr double kHall = 4.0;  // [m]

std::vector<Detection> detect_below(double height, const test::DrawnShape& shape) {
  CeilingCatalogue catalogue;
  catalogue.ceiling_height = kRoom;
  for (const double each : {kRoom, kHall}) {
    catalogue.fixtures.push_back({.length = 1.2, .width = 0.3, .height = each, .lamps = 1});
  }
  test::DrawnCeiling ceiling;
  ceiling.shapes = {shape};
  Detector detector({}, test::test_camera(), catalogue);
  return detector.detect(test::draw_ceiling(ceiling, test::test_camera(), height).view());
}

TEST(SeveralHeights, PlaceAWholeFixtureBelowItsOwnCeiling) {
  for (const double height : {kRoom, kHall}) {
    for (const DetectionState state : {DetectionState::kLit, DetectionState::kUnlit}) {
      const Pose2 pose{0.2, 0.15, 0.5};
      const auto detections = detect_below(height, {.pose = pose, .state = state});
      ASSERT_EQ(detections.size(), 1U) << height;
      test::expect_at(detections[0], pose, 0.01, radians(0.3));
    }
  }
}

TEST(SeveralHeights, SayNothingFalselySureOfACutFixture) {
  for (const double height : {kRoom, kHall}) {
    for (const double y : {0.9, 1.1, 1.3, 1.5}) {
      const Pose2 pose{0.1, y, 1.4};
      for (const Detection& detection : detect_below(height, {.pose = pose})) {
        const Eigen::Vector2d error = detection.robot_from_fixture.position() - pose.position();
        const Eigen::Matrix2d covariance = detection.covariance.topLeftCorner<2, 2>();
        EXPECT_LT(error.dot(covariance.inverse() * error), 16.0) << height << " m, y " << y << ", off " << error.norm();
      }
    }
  }
}

}  // namespace
}  // namespace luminav
