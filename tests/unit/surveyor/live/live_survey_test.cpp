#include "services/surveyor/live/live_survey.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

/// A corridor with a lamp every 2.5 m, driven to its end and half the way back.
class LiveSurveyTest : public testing::Test {
 protected:
  LiveSurveyTest() {
    std::vector<Fixture> fixtures;
    for (int i = 0; i < 6; ++i) {
      fixtures.push_back(fixture_at(i + 1, 1.0 + 2.5 * i, 0.0, 0.0));
    }
    synthetic_ = drive_along({{0.0, 0.0}, {15.0, 0.0}, {6.0, 0.0}}, fixtures, model_, {});
    log_.drive.has_lengths = true;
  }

  /// Drives on until `distance` [m] are driven in all.
  void drive_to(double distance) {
    const SurveyDrive& whole = synthetic_.drive;
    while (log_.drive.odometry.size() < whole.odometry.size() && survey_.distance() < distance) {
      const OdometryReading& reading = whole.odometry[log_.drive.odometry.size()];
      for (std::size_t i = log_.drive.frames.size(); i < whole.frames.size() && whole.frames[i].utime < reading.utime;
           ++i) {
        log_.drive.frames.push_back(whole.frames[i]);
      }
      log_.drive.odometry.push_back(reading);
      log_.drive.odometry.back().session = session_;
      survey_.add(log_.drive.odometry.back());
    }
  }

  void estimate() {
    survey_.begin_estimate();
    survey_.take(estimate_so_far(log_, model_));
  }

  SurveyModel model_ = synthetic_model();
  SyntheticDrive synthetic_;
  SurveyLog log_;
  LiveSurvey survey_{model_};
  std::int64_t session_ = 1;
};

TEST_F(LiveSurveyTest, ShowsNothingBeforeTheDrive) {
  const LiveMap map = survey_.map(log_);
  EXPECT_THAT(map.fixtures, IsEmpty());
  EXPECT_FALSE(map.world_from_robot);
}

TEST_F(LiveSurveyTest, DrawsByOdometryBeforeTheFirstEstimate) {
  drive_to(5.0);
  const LiveMap map = survey_.map(log_);
  ASSERT_THAT(map.fixtures, SizeIs(2));
  EXPECT_TRUE(map.fixtures[1].is_provisional);
  EXPECT_NEAR(map.fixtures[1].world_from_fixture.x, 3.5, 0.01);
  ASSERT_TRUE(map.world_from_robot);
  EXPECT_NEAR(map.world_from_robot->x, map.distance, 0.01);
}

TEST_F(LiveSurveyTest, GoesOnByOdometryBehindAnEstimate) {
  drive_to(10.0);
  estimate();
  drive_to(14.5);
  const LiveMap map = survey_.map(log_);
  EXPECT_NEAR(map.estimated_distance, 10.0, 0.1);
  EXPECT_NEAR(map.distance, 14.5, 0.1);
  ASSERT_THAT(map.fixtures, SizeIs(6));
  EXPECT_FALSE(map.fixtures[0].is_provisional);
  EXPECT_GT(map.fixtures[0].covariance.trace(), 0.0);
  EXPECT_TRUE(map.fixtures[5].is_provisional);
  EXPECT_NEAR(map.fixtures[5].world_from_fixture.x, 13.5, 0.05);
  ASSERT_TRUE(map.world_from_robot);
  EXPECT_NEAR(map.world_from_robot->x, 14.5, 0.1);
}

TEST_F(LiveSurveyTest, AFixturePassedAgainIsNoNewOne) {
  drive_to(15.5);
  estimate();
  drive_to(100.0);
  const LiveMap map = survey_.map(log_);
  EXPECT_THAT(map.fixtures, SizeIs(6));
  ASSERT_TRUE(map.world_from_robot);
  EXPECT_NEAR(map.world_from_robot->x, 6.0, 0.1);
}

TEST_F(LiveSurveyTest, TheMapStaysWhereItIsFromOneEstimateToTheNext) {
  drive_to(10.0);
  estimate();
  const Pose2 before = survey_.map(log_).fixtures[0].world_from_fixture;
  drive_to(100.0);
  estimate();
  const Pose2 after = survey_.map(log_).fixtures[0].world_from_fixture;
  EXPECT_NEAR(before.x, after.x, 0.05);
  EXPECT_NEAR(before.y, after.y, 0.05);
}

TEST_F(LiveSurveyTest, AnEstimateIsDueWhenTheDriveHasGrownByAFifth) {
  drive_to(9.0);
  EXPECT_FALSE(survey_.is_estimate_due());
  drive_to(10.1);
  EXPECT_TRUE(survey_.is_estimate_due());
  survey_.begin_estimate();
  EXPECT_FALSE(survey_.is_estimate_due());
  drive_to(19.0);
  EXPECT_FALSE(survey_.is_estimate_due());
  drive_to(20.5);
  EXPECT_TRUE(survey_.is_estimate_due());
}

TEST_F(LiveSurveyTest, DoesNotKnowWhereTheRobotIsOnceOdometryBeganAnew) {
  drive_to(10.0);
  estimate();
  session_ = 2;
  drive_to(12.0);
  const LiveMap map = survey_.map(log_);
  EXPECT_FALSE(map.world_from_robot);
  EXPECT_NEAR(map.distance, 12.0, 0.1);
}

TEST_F(LiveSurveyTest, ShowsPlacesWhereTheyWereNamed) {
  drive_to(3.0);
  log_.places.push_back({"lift", log_.drive.odometry.back().utime, 1});
  drive_to(10.0);
  estimate();
  drive_to(12.0);
  log_.places.push_back({"kitchen", log_.drive.odometry.back().utime, 2});
  const LiveMap map = survey_.map(log_);
  ASSERT_THAT(map.places, SizeIs(2));
  EXPECT_NEAR(map.places[0].position.x(), 3.0, 0.1);
  EXPECT_NEAR(map.places[1].position.x(), 12.0, 0.1);
}

}  // namespace
}  // namespace luminav
