#include "services/localizer/integrity/kidnap_opportunity.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

/// A robot whose pose has just predicted a fixture.
class KidnapOpportunities : public ::testing::Test {
 protected:
  KidnapOpportunities() {
    (void)kidnap_.look(odom_);
    kidnap_.match();
  }
  /// So many images, before each of which the wheels turn by `step`; returns in how many an opportunity began.
  int see(int images, const Pose2& step = {}) {
    int begun = 0;
    for (int i = 0; i < images; ++i) {
      odom_ = odom_ * step;
      begun += kidnap_.look(odom_) ? 1 : 0;
    }
    return begun;
  }

  TrackingRules rules_;
  KidnapOpportunity kidnap_{rules_};
  Pose2 odom_{1.0, 0.0, 0.0};
};

TEST_F(KidnapOpportunities, AreNoneWhileTheWheelsTurn) {
  EXPECT_EQ(see(100, {0.03, 0.0, 0.0}), 0);
  EXPECT_TRUE(kidnap_.is_excluded());
  EXPECT_FALSE(kidnap_.was_given() || kidnap_.are_wheels_still() || kidnap_.stands_still());
  EXPECT_NEAR(kidnap_.since_match().x, 3.0, 1e-9);
}

TEST_F(KidnapOpportunities, BeginWhereTheWheelsComeToRestAndAreGivenAfterAPause) {
  see(1, {0.03, 0.0, 0.0});
  EXPECT_EQ(see(KidnapOpportunity::kHaltFrames - 1), 1);
  EXPECT_TRUE(kidnap_.is_excluded() && kidnap_.are_wheels_still());
  see(1);
  EXPECT_FALSE(kidnap_.is_excluded() || kidnap_.was_given());
  EXPECT_EQ(see(rules_.pause_frames), 0);
  EXPECT_TRUE(kidnap_.was_given());
  see(1, {0.03, 0.0, 0.0});
  EXPECT_EQ(see(rules_.pause_frames), 0) << "one is there already";
  EXPECT_TRUE(kidnap_.was_given());
}

TEST_F(KidnapOpportunities, EndWithAMatch) {
  see(rules_.pause_frames);
  ASSERT_TRUE(kidnap_.was_given());
  kidnap_.match();
  EXPECT_TRUE(kidnap_.is_excluded());
  EXPECT_FALSE(kidnap_.was_given() || kidnap_.are_wheels_still());
}

TEST_F(KidnapOpportunities, AreGivenWhileTheMotorsAreOff) {
  kidnap_.set_motors_off(true);
  kidnap_.match();
  EXPECT_TRUE(kidnap_.was_given());
  EXPECT_FALSE(kidnap_.is_excluded());
  kidnap_.set_motors_off(false);
  EXPECT_FALSE(kidnap_.was_given());
}

TEST_F(KidnapOpportunities, FindARobotStandingThatRolledOnALittle) {
  EXPECT_TRUE(kidnap_.stands_still());
  see(1, {0.1, 0.0, 0.0});
  EXPECT_FALSE(kidnap_.stands_still());
  see(rules_.vanish_frames);
  EXPECT_TRUE(kidnap_.stands_still());
}

}  // namespace
}  // namespace luminav
