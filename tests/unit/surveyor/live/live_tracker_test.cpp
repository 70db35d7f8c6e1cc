#include "services/surveyor/live/live_tracker.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

/// An estimate that ends at the origin, with fixtures of one kind, each known to so many metres.
LiveEstimate estimate_with(const std::vector<Pose2>& fixtures, double sigma) {
  LiveEstimate estimate;
  for (const Pose2& world_from_fixture : fixtures) {
    estimate.survey.estimate.fixtures.push_back({0, {}, world_from_fixture});
    JudgedFixture judged;
    judged.covariance = Eigen::Vector3d(sigma * sigma, sigma * sigma, 1e-4).asDiagonal();
    estimate.survey.fixtures.push_back(judged);
  }
  return estimate;
}

class LiveTrackerTest : public testing::Test {
 protected:
  /// Drives 4 m by odometry that is right, and looks up from where the robot truly is.
  void drive_and_look(const Pose2& world_from_robot, const Pose2& world_from_fixture) {
    const OdometryReading before{0, 1, {}, 0.0, 0.0};
    const OdometryReading now{1'000'000, 1, {4.0, 0.0, 0.0}, 0.0, 0.0};
    tracker_.drive(before, now);
    FixtureSighting sighting;
    sighting.robot_from_fixture = world_from_robot.inverse() * world_from_fixture;
    sighting.covariance = 1e-5 * Eigen::Matrix3d::Identity();
    for (int i = 0; i < 20; ++i) {
      tracker_.look({1'000'000, {sighting}}, {}, 0.0, 0.0);
    }
  }

  SurveyModel model_ = synthetic_model();
  LiveTracker tracker_{model_};
  const Pose2 fixture_{4.5, 0.3, 0.2};
};

TEST_F(LiveTrackerTest, DrivesByOdometryWhereNothingIsKnown) {
  drive_and_look({4.0, 0.1, 0.0}, fixture_);
  EXPECT_NEAR(tracker_.belief().pose.y, 0.0, 1e-9);
  EXPECT_NEAR(tracker_.driven(), 4.0, 1e-9);
}

TEST_F(LiveTrackerTest, IsPutRightByAFixtureOfTheMap) {
  tracker_.begin(estimate_with({fixture_}, 0.03));
  drive_and_look({4.0, 0.1, 0.02}, fixture_);
  EXPECT_NEAR(tracker_.belief().pose.y, 0.1, 0.02);
  EXPECT_NEAR(tracker_.belief().pose.theta, 0.02, 0.01);
}

TEST_F(LiveTrackerTest, LeavesAloneWhatMayBeTwo) {
  tracker_.begin(estimate_with({fixture_, fixture_ * Pose2{0.0, 0.15, 0.0}}, 0.03));
  drive_and_look({4.0, 0.1, 0.0}, fixture_);
  EXPECT_NEAR(tracker_.belief().pose.y, 0.0, 1e-9);
}

TEST_F(LiveTrackerTest, TrustsNoFixtureThatIsHardlyKnown) {
  tracker_.begin(estimate_with({fixture_}, 0.3));
  drive_and_look({4.0, 0.1, 0.0}, fixture_);
  EXPECT_NEAR(tracker_.belief().pose.y, 0.0, 1e-9);
}

TEST_F(LiveTrackerTest, IsNotMisledByWhatIsNew) {
  tracker_.begin(estimate_with({fixture_}, 0.03));
  drive_and_look({4.0, 0.0, 0.0}, {3.4, 0.3, 0.2});
  EXPECT_NEAR(tracker_.belief().pose.x, 4.0, 1e-9);
}

}  // namespace
}  // namespace luminav
