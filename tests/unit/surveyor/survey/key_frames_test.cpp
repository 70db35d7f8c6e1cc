#include "services/surveyor/survey/key_frames.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

std::vector<KeyFrame> frames_of(const SurveyDrive& drive) {
  return choose_key_frames(drive, synthetic_model().robot.camera, 2.8);
}

TEST(KeyFrames, LieApartByTheirSpacingOrATurn) {
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {3.0, 0.0}, {3.0, 2.0}}, {}, synthetic_model(), {});
  const std::vector<KeyFrame> frames = frames_of(synthetic.drive);
  ASSERT_GT(frames.size(), 30u);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Pose2 step = frames[i - 1].odom_from_robot.inverse() * frames[i].odom_from_robot;
    EXPECT_TRUE(std::hypot(step.x, step.y) >= kKeyFrameSpacing || std::abs(step.theta) >= kKeyFrameTurn);
  }
}

TEST(KeyFrames, CarryAllTheMotionBetweenThem) {
  const SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {3.0, 0.0}, {3.0, 2.0}}, {}, synthetic_model(), {});
  const std::vector<KeyFrame> frames = frames_of(synthetic.drive);
  Pose2 pose = frames.front().odom_from_robot;
  for (const KeyFrame& frame : frames) {
    for (const Pose2& step : frame.steps) {
      pose = pose * step;
    }
  }
  EXPECT_NEAR(distance(pose, frames.back().odom_from_robot), 0.0, 1e-9);
  EXPECT_NEAR(frames.back().travelled, 5.0, 0.2);
}

TEST(KeyFrames, BeginANewPartWhereOdometryBeginsAnew) {
  SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {4.0, 0.0}}, {}, synthetic_model(), {});
  for (std::size_t i = synthetic.drive.odometry.size() / 2; i < synthetic.drive.odometry.size(); ++i) {
    synthetic.drive.odometry[i].session = 2;
  }
  const std::vector<KeyFrame> frames = frames_of(synthetic.drive);
  EXPECT_EQ(frames.front().part, 0);
  EXPECT_EQ(frames.back().part, 1);
  int first_ones = 0;
  for (const KeyFrame& frame : frames) {
    first_ones += frame.steps.empty() ? 1 : 0;
  }
  EXPECT_EQ(first_ones, 2);
}

/// The drive without what came between two times, shares of it.
SurveyDrive without(SurveyDrive drive, double from, double to) {
  const auto count = static_cast<double>(drive.odometry.size());
  drive.odometry.erase(drive.odometry.begin() + static_cast<std::ptrdiff_t>(from * count),
                       drive.odometry.begin() + static_cast<std::ptrdiff_t>(to * count));
  return drive;
}

TEST(KeyFrames, BeginANewPartWhereTheRobotDroveOnUnheard) {
  const SyntheticDrive long_drive = drive_along({{0.0, 0.0}, {6.0, 0.0}, {6.0, 6.0}}, {}, synthetic_model(), {});
  EXPECT_EQ(frames_of(without(long_drive.drive, 0.4, 0.6)).back().part, 1);
  EXPECT_EQ(frames_of(without(long_drive.drive, 0.4, 0.44)).back().part, 0) << "1.3 s";
  SurveyDrive standing = long_drive.drive;
  for (OdometryReading& reading : standing.odometry) {
    reading.odom_from_robot = {};
  }
  EXPECT_EQ(frames_of(without(standing, 0.4, 0.6)).back().part, 0);
}

TEST(KeyFrames, AreNoneWhereTheRobotStands) {
  SyntheticDrive synthetic = drive_along({{0.0, 0.0}, {1.0, 0.0}}, {}, synthetic_model(), {});
  for (OdometryReading& reading : synthetic.drive.odometry) {
    reading.odom_from_robot = {};
  }
  EXPECT_EQ(frames_of(synthetic.drive).size(), 1u);
}

/// Mean length of the lit or unlit bars of a drive below one, whose image is exposed for so long [s].
double mean_length(double heading, double exposure, SightingState state) {
  SurveyDrive drive;
  for (int i = 0; i < 100; ++i) {
    drive.odometry.push_back({100'000 * (i + 1), 1, {0.05 * i, 0.0, 0.0}, 0.5, 0.0});
    FixtureSighting bar;
    bar.robot_from_fixture = {0.2, 0.1, heading};
    bar.state = state;
    bar.length = 1.2;
    drive.frames.push_back({.utime = 100'000 * (i + 1), .sightings = {bar}, .exposure = exposure});
  }
  const std::vector<KeyFrame> frames = choose_key_frames(drive, {}, 2.8);
  double sum = 0.0;
  for (const KeyFrame& frame : frames) {
    sum += frame.sightings.front().length;
  }
  return sum / static_cast<double>(frames.size());
}

TEST(KeyFrames, TakeTheBlurOfMotionOffWhatIsLit) {
  const auto blur = [](double heading, SightingState state) {
    return mean_length(heading, 0.0, state) - mean_length(heading, 0.02, state);
  };
  EXPECT_NEAR(blur(0.0, SightingState::kLit), 0.005, 1e-6) << "half of 10 mm along it";
  EXPECT_NEAR(blur(0.5 * kPi, SightingState::kLit), -0.005, 1e-6) << "across, where it was taken for bloom";
  EXPECT_EQ(blur(0.0, SightingState::kUnlit), 0.0);
}

}  // namespace
}  // namespace luminav
