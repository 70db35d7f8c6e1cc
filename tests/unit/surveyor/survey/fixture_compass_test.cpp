#include "services/surveyor/survey/fixture_compass.hpp"

#include <gtest/gtest.h>

#include "services/surveyor/survey/wheel_guess.hpp"
#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

/// Fixtures along 400 m, along the way and across it in turn.
std::vector<Fixture> long_corridor() {
  std::vector<Fixture> fixtures;
  for (int i = 0; i < 160; ++i) {
    fixtures.push_back(fixture_at(i + 1, 2.5 * i, 0.0, i % 2 == 0 ? 0.0 : 0.5 * kPi));
  }
  return fixtures;
}

/// The way by wheels that turn the robot by half a radian on it, as a guess of the wheels leaves it.
struct CurledDrive {
  explicit CurledDrive(const std::vector<Fixture>& fixtures) {
    const SurveyModel model = synthetic_model();
    SyntheticErrors errors;
    errors.wheels.ratio = 0.0005;
    const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {400.0, 0.0}}, fixtures, model, errors);
    frames = choose_key_frames(synthetic.drive, model.robot.camera, 2.8);
    passes = find_passes(frames, model.kinds);
    path = dead_reckoning(frames, model.robot.wheel_base, {});
  }
  std::vector<KeyFrame> frames;
  std::vector<FixturePass> passes;
  std::vector<Pose2> path;
};

TEST(FixtureCompass, HoldsTheHeadingOfALongWay) {
  const CurledDrive drive(long_corridor());
  ASSERT_GT(std::abs(drive.path.back().theta), 0.5);
  const std::vector<Pose2> held = hold_heading(drive.path, drive.passes);
  ASSERT_EQ(held.size(), drive.path.size());
  for (const Pose2& pose : held) {
    EXPECT_NEAR(pose.theta, 0.0, radians(4.0));
  }
  EXPECT_LT(std::abs(held.back().y), 0.1 * std::abs(drive.path.back().y));
}

TEST(FixtureCompass, IsHardlyTurnedByFixturesThatHangAskew) {
  std::vector<Fixture> fixtures = long_corridor();
  for (std::size_t i = 5; i < fixtures.size(); i += 10) {
    fixtures[i].world_from_fixture.theta += radians(25.0);
  }
  const CurledDrive drive(fixtures);
  for (const Pose2& pose : hold_heading(drive.path, drive.passes)) {
    EXPECT_NEAR(pose.theta, 0.0, radians(5.0));
  }
}

TEST(FixtureCompass, LeavesAPathBelowNothingAsItIs) {
  const std::vector<Pose2> path = {{1.0, 2.0, 0.5}, {1.5, 2.5, 0.8}, {2.0, 3.5, 1.4}};
  const std::vector<Pose2> held = hold_heading(path, {});
  ASSERT_EQ(held.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_NEAR(distance(held[i], path[i]), 0.0, 1e-12);
    EXPECT_NEAR(held[i].theta, path[i].theta, 1e-12);
  }
}

}  // namespace
}  // namespace luminav
