#include "tests/evaluation/sensing/fixture_view.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace luminav {
namespace {

/// One fixture of 1.2 x 0.3 m at the origin, 2.8 m up; the camera is as believed.
struct Ceiling {
  explicit Ceiling(const Pose2& fixture_pose = {}) {
    Fixture fixture;
    fixture.id = 1;
    fixture.world_from_fixture = fixture_pose;
    world.building.fixtures = {fixture};
    world.robot.camera.mounting.z = 0.3;
    believed = world.building;
  }
  std::vector<FixtureView> from(const Pose2& pose, Eigen::Vector2d velocity = {0.0, 0.0}, double angular = 0.0) {
    CeilingViewer viewer(world, believed, believed_camera());
    std::vector<FixtureView> views;
    viewer.look({{pose, 0.0, 0.0}, velocity, angular}, {}, 0.01, views);
    return views;
  }
  [[nodiscard]] CameraDescription believed_camera() const {
    CameraDescription camera;
    camera.mounting.z = 0.3;
    camera.row_time = world.robot.camera.row_time;
    return camera;
  }
  WorldTruth world;
  Building believed;
};

TEST(CeilingViewer, SeesAFixtureOverheadWhereItIs) {
  Ceiling ceiling({0.2, 0.1, 0.4});
  const auto views = ceiling.from({0.1, -0.1, 0.3});
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views[0].share, 1.0);
  EXPECT_TRUE(views[0].near_end && views[0].far_end);
  const Pose2 expected = Pose2{0.1, -0.1, 0.3}.inverse() * Pose2{0.2, 0.1, 0.4};
  const Pose2 seen = views[0].robot_from_fixture(true, true);
  EXPECT_NEAR(seen.x, expected.x, 1e-6);
  EXPECT_NEAR(seen.y, expected.y, 1e-6);
  EXPECT_NEAR(seen.theta, expected.theta, 1e-6);
}

TEST(CeilingViewer, DoesNotSeeWhatIsFarAway) {
  Ceiling ceiling;
  EXPECT_TRUE(ceiling.from({4.0, 0.0, 0.0}).empty());
}

TEST(CeilingViewer, SaysWhichEndOfACutFixtureIsInTheImage) {
  Ceiling ceiling;
  // The image reaches 1.08 m to the front (its short side is along x); the far end is beyond it.
  const auto views = ceiling.from({-0.9, 0.0, 0.0});
  ASSERT_EQ(views.size(), 1U);
  EXPECT_TRUE(views[0].near_end);
  EXPECT_FALSE(views[0].far_end);
  EXPECT_GT(views[0].share, 0.5);
  EXPECT_LT(views[0].share, 0.8);
  const Pose2 seen = views[0].robot_from_fixture(true, false);
  EXPECT_NEAR(seen.x, 0.9, 1e-6);
  // and to whoever sees no end, the middle of the stretch is all there is
  EXPECT_LT(views[0].robot_from_fixture(false, false).x, 0.75);
}

TEST(CeilingViewer, ShowsATiltedCameraAsAnErrorThatDependsOnThePose) {
  Ceiling ceiling;
  ceiling.world.robot.camera.mounting.pitch = radians(0.5);
  const auto views = ceiling.from({0.0, 0.0, 0.0});
  ASSERT_EQ(views.size(), 1U);
  // 2.5 m * tan(0.5 degrees) = 22 mm, nearly all along x
  EXPECT_NEAR(std::abs(views[0].robot_from_fixture(true, true).x), 2.5 * std::tan(radians(0.5)), 0.002);
  EXPECT_NEAR(views[0].robot_from_fixture(true, true).y, 0.0, 1e-6);
}

TEST(CeilingViewer, ShowsAHigherCeilingAsAFixtureNearerToTheMiddle) {
  Ceiling ceiling({0.4, 0.0, kPi / 2.0});
  ceiling.world.building.fixtures[0].height = 2.9;
  const auto views = ceiling.from({0.0, 0.0, 0.0});
  ASSERT_EQ(views.size(), 1U);
  EXPECT_NEAR(views[0].robot_from_fixture(true, true).x, 0.4 * 2.5 / 2.6, 1e-6);
}

TEST(CeilingViewer, ShearsTheImageOfARobotThatTurns) {
  Ceiling ceiling;
  ceiling.world.robot.camera.row_time = 25e-3 / 480;
  // Rows run along the robot's x: from one end of this fixture to the other the robot turns on and moves sideways.
  const auto views = ceiling.from({0.0, 0.0, 0.0}, {0.0, 0.5}, 0.0);
  ASSERT_EQ(views.size(), 1U);
  const double rows = 554.0 * 1.2 / 2.5;
  const double shear = 0.5 * rows * 25e-3 / 480 / 1.2;
  EXPECT_NEAR(std::abs(views[0].robot_from_fixture(true, true).theta), shear, 0.05 * shear);
}

TEST(CeilingViewer, SeesAMovedLampWhereItHangsNow) {
  Ceiling ceiling;
  CeilingViewer viewer(ceiling.world, ceiling.believed, ceiling.believed_camera());
  std::vector<FixtureView> views;
  viewer.look({{{0.0, 0.0, 0.0}, 0.0, 0.0}, {0.0, 0.0}, 0.0}, {{0, 0.3, 0.0, 0.0}}, 0.01, views);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_NEAR(views[0].robot_from_fixture(true, true).x, 0.3, 1e-6);
}

}  // namespace
}  // namespace luminav
