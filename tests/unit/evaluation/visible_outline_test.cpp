#include "tests/evaluation/detector_score/visible_outline.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/common/geometry/pose2.hpp"

namespace luminav::score {
namespace {

constexpr double kHeight = 2.8;

CeilingCamera camera() {
  return {CameraIntrinsics{}, CameraMounting{.z = 0.3}};
}

Fixture fixture() {
  Fixture made;
  made.length = 1.2;
  made.width = 0.3;
  made.height = kHeight;
  return made;
}

/// A fixture that is brighter by that than a ceiling of 100.
GreyImage picture_of(const Pose2& robot_from_fixture, int brighter) {
  GreyImage image;
  image.width = 640;
  image.height = 480;
  image.pixels.assign(640 * 480, 100);
  const CeilingCamera lens = camera();
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const auto point = lens.point_on_ceiling({x, y}, kHeight);
      const Eigen::Vector2d place = robot_from_fixture.inverse() * *point;
      if (std::abs(place.x()) < 0.6 && std::abs(place.y()) < 0.15) {
        image.pixels[static_cast<std::size_t>(640 * y + x)] = static_cast<std::uint8_t>(100 + brighter);
      }
    }
  }
  return image;
}

TEST(SeenShare, IsAllOfAnOutlineThatStepsByMoreThanAPersonNeeds) {
  const Pose2 pose{0.1, 0.05, 0.4};
  EXPECT_EQ(seen_share(picture_of(pose, 8).view(), camera(), fixture(), pose), 1.0);
  EXPECT_EQ(seen_share(picture_of(pose, -8).view(), camera(), fixture(), pose), 1.0);
}

TEST(SeenShare, IsNothingWhereTheStepIsTooFaintOrTheFixtureElsewhere) {
  const Pose2 pose{0.1, 0.05, 0.4};
  EXPECT_EQ(seen_share(picture_of(pose, 4).view(), camera(), fixture(), pose), 0.0);
  EXPECT_EQ(seen_share(picture_of(pose, 100).view(), camera(), fixture(), {9.0, 0.0, 0.0}), 0.0);
}

TEST(SeenShare, CountsWhatTheBorderLeavesOfACutOne) {
  const Pose2 half{1.0, 0.0, 0.0};
  EXPECT_EQ(seen_share(picture_of(half, 20).view(), camera(), fixture(), half), 1.0);
}

}  // namespace
}  // namespace luminav::score
