#include "services/localizer/integrity/missing_fixtures.hpp"

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
class MissingFixturesTest : public ::testing::Test {
 protected:
  static PoseBelief under(double x) { return {{x, 5.0, 0.0}, 1e-6 * Eigen::Matrix3d::Identity()}; }
  /// So many images at a place, without a fixture; returns in how many one ought to be in view.
  int miss(double x, int images, double step = 0.0) {
    int missed = 0;
    for (int i = 0; i < images; ++i) {
      odom_ = odom_ * Pose2{step, 0.0, 0.0};
      (void)kidnap_.look(odom_);
      missed += missing_.look({}, under(x), kidnap_) ? 1 : 0;
    }
    return missed;
  }
  void match(double x, int fixture) {
    (void)kidnap_.look(odom_);
    kidnap_.match();
    missing_.match({{0, fixture, 0.0}}, under(x));
  }

  TrackingRules rules_;
  ObservationModel model_{two_fixtures(), {}, {}, {}};
  KidnapOpportunity kidnap_{rules_};
  MissingFixtures missing_{model_, rules_};
  Pose2 odom_;
};

TEST_F(MissingFixturesTest, AreNoneWhereNoFixtureIsInView) {
  EXPECT_EQ(miss(12.0, 30), 0);
  EXPECT_FALSE(missing_.find(100.0, true));
}

TEST_F(MissingFixturesTest, AreOneAfterAWhileAndAWay) {
  EXPECT_EQ(miss(5.0, rules_.miss_frames - 1, 0.03), rules_.miss_frames - 1);
  EXPECT_FALSE(missing_.find(rules_.miss_distance + 0.1, false));
  miss(5.0, 1, 0.03);
  EXPECT_FALSE(missing_.find(rules_.miss_distance - 0.1, false));
  EXPECT_EQ(missing_.find(rules_.miss_distance + 0.1, false), 0);
}

TEST_F(MissingFixturesTest, AreSeveralWhateverTheWayIs) {
  miss(5.0, rules_.miss_frames, 0.03);
  miss(20.0, rules_.miss_frames + 1, 0.03);
  EXPECT_EQ(missing_.find(0.0, false), 1) << "the one that was missed more often";
  missing_.restart();
  EXPECT_FALSE(missing_.find(0.0, true));
}

TEST_F(MissingFixturesTest, AreThereAtOnceForARobotThatMayHaveBeenCarried) {
  miss(5.0, 1, 0.03);
  EXPECT_EQ(missing_.find(0.0, true), 0);
}

TEST_F(MissingFixturesTest, AreWhatVanishesFromAStandingRobot) {
  match(5.0, 0);
  miss(5.0, rules_.vanish_frames - 1);
  EXPECT_FALSE(missing_.find(0.0, false));
  miss(5.0, 1);
  EXPECT_EQ(missing_.find(0.0, false), 0);
  match(5.0, 0);
  EXPECT_FALSE(missing_.find(0.0, false));
}

TEST_F(MissingFixturesTest, AreNoneThatTheMapDoubtsOrTheImageShowsOrCannotShow) {
  FixtureSighting sighting;
  (void)kidnap_.look(odom_);
  EXPECT_FALSE(missing_.look({0, {sighting}}, under(5.0), kidnap_));
  SightingFrame for_lamps;
  for_lamps.shows_unlit = false;
  EXPECT_FALSE(missing_.look(for_lamps, under(5.0), kidnap_));
  model_.fixtures.doubt(0);
  EXPECT_EQ(miss(5.0, 1), 0);
}

}  // namespace
}  // namespace luminav
