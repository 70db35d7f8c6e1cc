#include "services/surveyor/live/live_ground.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/survey/synthetic_drive.hpp"

namespace luminav {
namespace {

constexpr double kCrooked = radians(10.0);  // [rad] per 10 m that the wheels turn without telling

/// Below a row of lamps, with walls at 1 m to both sides, by odometry that bends.
class LiveGroundTest : public testing::Test {
 protected:
  LiveGroundTest() {
    std::vector<Fixture> fixtures;
    for (int i = 0; i < 6; ++i) {
      fixtures.push_back(fixture_at(i + 1, 1.0 + 2.5 * i, 0.0, 0.0));
    }
    SyntheticErrors errors;
    errors.wheels.ratio = kCrooked / 10.0 * model_.robot.wheel_base;
    synthetic_ = drive_along({{0.0, 0.0}, {15.0, 0.0}}, fixtures, model_, errors);
    log_.drive.has_lengths = true;
  }

  void drive_to(double x) {
    const SurveyDrive& whole = synthetic_.drive;
    while (log_.drive.odometry.size() < whole.odometry.size() &&
           whole.odometry[log_.drive.odometry.size()].odom_from_robot.position().norm() < x) {
      const OdometryReading& reading = whole.odometry[log_.drive.odometry.size()];
      for (std::size_t i = log_.drive.frames.size(); i < whole.frames.size() && whole.frames[i].utime < reading.utime;
           ++i) {
        log_.drive.frames.push_back(whole.frames[i]);
      }
      log_.drive.odometry.push_back(reading);
      log_.drive.odometry.back().session = session_;
      ground_.add(log_.drive.odometry.back());
      for (int disc = 0; disc < 16; ++disc) {  // they come after the odometry of their time
        const Pose2& mounted = model_.robot.sonar.robot_from_sonar[static_cast<std::size_t>(disc)];
        if (std::abs(std::sin(mounted.theta)) > 0.99) {
          log_.drive.echoes.push_back({disc, 1.0 - std::abs(mounted.y), true, reading.utime - 1000});
          ground_.add(log_.drive.echoes.back());
        }
      }
    }
  }

  void estimate() {
    LiveEstimate estimate = estimate_so_far(log_, model_);
    draw(estimate, log_, model_);
    ground_.take(estimate, log_);
  }

  [[nodiscard]] bool is_wall(double x, double y) const {
    const GridGeometry& geometry = ground_.map().grid().geometry;
    bool is_wall = false;
    for (double aside = -0.15; aside < 0.2; aside += 0.1) {
      const Cell cell = geometry.cell_at({x, y + aside});
      is_wall |= geometry.contains(cell) && ground_.map().grid().evidence[geometry.index(cell)] > 16;
    }
    return is_wall;
  }

  SurveyModel model_ = synthetic_model();
  SyntheticDrive synthetic_;
  SurveyLog log_;
  LiveGround ground_{model_};
  std::int64_t session_ = 1;
};

TEST_F(LiveGroundTest, DrawsTheWallsBesideTheRobotAsItDrives) {
  drive_to(3.0);
  EXPECT_TRUE(is_wall(1.0, 1.0));
  EXPECT_TRUE(is_wall(1.0, -1.0));
  EXPECT_FALSE(is_wall(1.0, 0.0));
}

TEST_F(LiveGroundTest, AnEstimateStraightensTheMapAndThePathBehindIt) {
  drive_to(11.0);
  EXPECT_FALSE(is_wall(10.0, 1.0) && is_wall(10.0, -1.0));
  const int before = ground_.drawing();
  estimate();
  EXPECT_GT(ground_.drawing(), before);
  EXPECT_TRUE(is_wall(10.0, 1.0));
  EXPECT_TRUE(is_wall(10.0, -1.0));
  EXPECT_NEAR(ground_.since_estimate(), 0.0, 1e-9);
  drive_to(14.0);  // by wheels as they were found to be
  ASSERT_TRUE(ground_.here());
  EXPECT_NEAR(ground_.here()->world_from_robot.y, 0.0, 0.1);
  EXPECT_TRUE(is_wall(13.0, 1.0));
}

TEST_F(LiveGroundTest, WhatWasDrivenWhileAnEstimateWasMadeIsLaidOutBehindIt) {
  drive_to(10.0);
  LiveEstimate estimate = estimate_so_far(log_, model_);
  draw(estimate, log_, model_);
  drive_to(13.5);
  ground_.take(estimate, log_);
  ASSERT_TRUE(ground_.here());
  EXPECT_EQ(ground_.here()->utime, log_.drive.odometry.back().utime);
  EXPECT_NEAR(ground_.here()->world_from_robot.x, 13.5, 0.2);
  EXPECT_NEAR(ground_.here()->world_from_robot.y, 0.0, 0.1);
  EXPECT_TRUE(is_wall(12.5, -1.0));
}

TEST_F(LiveGroundTest, DoesNotKnowWhereTheRobotIsOnceOdometryBeganAnew) {
  drive_to(3.0);
  ++session_;
  drive_to(4.0);
  EXPECT_FALSE(ground_.here());
}

TEST_F(LiveGroundTest, MakesRoomBeforeTheRobotLeavesItsGrid) {
  drive_to(8.0);
  EXPECT_FALSE(ground_.is_narrow());
  drive_to(12.0);
  EXPECT_TRUE(ground_.is_narrow());
  ground_.redraw(log_);
  EXPECT_FALSE(ground_.is_narrow());
  EXPECT_TRUE(is_wall(1.0, 1.0));
}

TEST_F(LiveGroundTest, KeepsItsPlaceWhereAnEstimateDoesNotKnowTheEnd) {
  drive_to(11.0);
  LiveEstimate estimate = estimate_so_far(log_, model_);
  draw(estimate, log_, model_);
  estimate.end.reset();
  ground_.take(estimate, log_);
  ASSERT_TRUE(ground_.here());
  EXPECT_NEAR(ground_.since_estimate(), 11.0, 0.5);
}

TEST_F(LiveGroundTest, TellsWhereImagesWereTaken) {
  drive_to(3.0);
  const std::vector<Eigen::Vector2d> looks = ground_.looks(log_.drive.frames);
  ASSERT_GT(looks.size(), 10u);
  EXPECT_NEAR(looks.front().x(), 0.0, 0.2);
  EXPECT_NEAR(looks.back().x(), 3.0, 0.2);
}

}  // namespace
}  // namespace luminav
