#include "services/localizer/integrity/kidnap_opportunity.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr int kPause = KidnapOpportunity::kPauseFrames;

/// A robot whose pose has just predicted a fixture.
class KidnapOpportunities : public ::testing::Test {
 protected:
  KidnapOpportunities() {
    kidnap_.look(odom_);
    kidnap_.match();
  }
  /// So many images, before each of which the wheels turn by `step`.
  void see(int images, const Pose2& step = {}) {
    for (int i = 0; i < images; ++i) {
      odom_ = odom_ * step;
      kidnap_.look(odom_);
    }
  }

  KidnapOpportunity kidnap_;
  Pose2 odom_{1.0, 0.0, 0.0};
};

TEST_F(KidnapOpportunities, AreNoneWhileTheWheelsTurn) {
  see(100, {0.03, 0.0, 0.0});
  EXPECT_FALSE(kidnap_.was_given() || kidnap_.are_wheels_still() || kidnap_.stands_still());
  EXPECT_NEAR(kidnap_.since_match().x, 3.0, 1e-9);
}

TEST_F(KidnapOpportunities, AreGivenByAPauseAndStayUntilTheNextMatch) {
  see(1, {0.03, 0.0, 0.0});
  see(2);
  EXPECT_TRUE(kidnap_.are_wheels_still());
  EXPECT_FALSE(kidnap_.was_given());
  see(kPause);
  EXPECT_TRUE(kidnap_.was_given());
  see(1, {0.03, 0.0, 0.0});
  EXPECT_TRUE(kidnap_.was_given());
}

TEST_F(KidnapOpportunities, EndWithAMatch) {
  see(kPause);
  ASSERT_TRUE(kidnap_.was_given());
  kidnap_.match();
  EXPECT_FALSE(kidnap_.was_given() || kidnap_.are_wheels_still());
}

TEST_F(KidnapOpportunities, AreGivenWhileTheMotorsAreOff) {
  kidnap_.set_motors_off(true);
  kidnap_.match();
  EXPECT_TRUE(kidnap_.was_given());
  kidnap_.set_motors_off(false);
  EXPECT_FALSE(kidnap_.was_given());
}

TEST_F(KidnapOpportunities, FindARobotStandingThatRolledOnALittle) {
  see(1);
  EXPECT_TRUE(kidnap_.stands_still());
  see(1, {0.1, 0.0, 0.0});
  EXPECT_FALSE(kidnap_.stands_still());
  see(1);
  EXPECT_TRUE(kidnap_.stands_still());
  see(1, {0.1, 0.0, 0.0});
  see(1);
  EXPECT_FALSE(kidnap_.stands_still());
}

}  // namespace
}  // namespace luminav
