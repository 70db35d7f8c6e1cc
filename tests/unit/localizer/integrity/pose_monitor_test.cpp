#include "services/localizer/integrity/pose_monitor.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

Building two_fixtures() {
  Building building;
  building.fixtures.resize(2);
  building.fixtures[0].world_from_fixture = {5.0, 5.0, 0.0};
  building.fixtures[1].world_from_fixture = {20.0, 5.0, 0.0};
  return building;
}

/// A pose at which the camera should see one fixture or the other.
class PoseMonitorTest : public ::testing::Test {
 protected:
  static PoseBelief under(double x) { return {{x, 5.0, 0.0}, 1e-6 * Eigen::Matrix3d::Identity()}; }
  /// An image of what is seen so far ahead of a robot at a place, before which its wheels turned.
  std::optional<Contradiction> look(double x, const std::vector<double>& ahead, double step,
                                    const std::vector<FixtureMatch>& matches = {}) {
    odom_ = odom_ * Pose2{step, 0.0, 0.0};
    frame_.utime += 66'667;
    frame_.sightings.clear();
    for (const double place : ahead) {
      FixtureSighting& sighting = frame_.sightings.emplace_back();
      sighting.robot_from_fixture = {place, 0.0, 0.0};
      sighting.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    }
    tracks_.update(frame_, odom_, 0.0);
    return monitor_.look(frame_, tracks_, matches, under(x), odom_);
  }
  /// How many images of nothing at a place it takes until a fixture is said to be missing; as many as asked for: none.
  int miss(double x, int images, double step = 0.0) {
    int passed = 0;
    while (passed < images && !(contradiction_ = look(x, {}, step))) {
      ++passed;
    }
    return passed;
  }

  TrackingRules rules_;
  ObservationModel model_{two_fixtures(), {}, {}, {}};
  PoseMonitor monitor_{model_, rules_};
  ObjectTracks tracks_;
  SightingFrame frame_;
  Pose2 odom_{1.0, 0.0, 0.0};
  std::optional<Contradiction> contradiction_;  // the last one
};

TEST_F(PoseMonitorTest, MissesNothingWhereNoFixtureIsInView) {
  EXPECT_EQ(miss(12.0, 100, 0.03), 100);
}

TEST_F(PoseMonitorTest, DoesNotSuspectAPoseForOneFixtureThatARobotPasses) {
  EXPECT_EQ(miss(5.0, 100, 0.03), 100);
}

TEST_F(PoseMonitorTest, SuspectsAPoseForTheSecondFixtureThatIsMissed) {
  const int enough = static_cast<int>(log_evidence::kMaxMissed / log_evidence::kMissed);
  EXPECT_EQ(miss(5.0, enough, 0.03), enough);
  EXPECT_EQ(miss(20.0, 100, 0.03), enough - 1);
  ASSERT_TRUE(contradiction_);
  EXPECT_GE(contradiction_->missed_fixture, 0);
  EXPECT_FALSE(contradiction_->misfit);
}

TEST_F(PoseMonitorTest, SuspectsAPoseForOneFixtureAfterTheRobotMayHaveBeenCarried) {
  miss(12.0, KidnapOpportunity::kPauseFrames + 1);
  EXPECT_LT(miss(5.0, 100, 0.03), 5);
}

TEST_F(PoseMonitorTest, SuspectsAPoseForAFixtureThatVanishesFromAStandingRobot) {
  EXPECT_FALSE(look(5.0, {0.0}, 0.0, {{0, 0, 0.0}}));
  EXPECT_LT(miss(5.0, 100), KidnapOpportunity::kPauseFrames);
}

TEST_F(PoseMonitorTest, MissesNothingThatTheMapDoubtsOrTheImageShowsOrCannotShow) {
  frame_.shows_unlit = false;
  EXPECT_EQ(miss(5.0, 100), 100);
  frame_.shows_unlit = true;
  model_.fixtures.doubt(0);
  EXPECT_EQ(miss(5.0, 100), 100);
}

TEST_F(PoseMonitorTest, SuspectsAPoseForAThingThatFitsNothing) {
  std::optional<Contradiction> contradiction;
  int images = 1;
  while (!(contradiction = look(12.0, {0.3}, 0.0)) && images < 100) {
    ++images;
  }
  EXPECT_EQ(images, 1 + static_cast<int>(rules_.doubt / log_evidence::kMisfit)) << "the first one may be an accident";
  ASSERT_TRUE(contradiction->misfit);
  EXPECT_NEAR(contradiction->misfit->x(), 12.3, 1e-9);
}

TEST_F(PoseMonitorTest, SuspectsAPoseForThingsThatRushPastACarriedRobot) {
  int images = 0;
  while (!look(12.0, {0.5 * images}, 0.0) && images < 100) {
    ++images;
  }
  EXPECT_LT(images, 2 * KidnapOpportunity::kPauseFrames) << "no two show it where the wheels predict it";
}

TEST_F(PoseMonitorTest, ForgetsFalseAlarmsThatCalmImagesFollow) {
  for (int alarm = 0; alarm < 20; ++alarm) {
    for (int image = 0; image < 3; ++image) {
      EXPECT_FALSE(look(12.0, {0.3}, 0.03));
    }
    miss(12.0, 40, 0.03);
  }
}

TEST_F(PoseMonitorTest, BeginsAnewWithAMatch) {
  for (int i = 0; i < 20; ++i) {
    for (int image = 0; image < 3; ++image) {
      EXPECT_FALSE(look(5.0, {0.9}, 0.03));
    }
    EXPECT_FALSE(look(5.0, {0.0}, 0.03, {{0, 0, 0.0}}));
  }
}

}  // namespace
}  // namespace luminav
