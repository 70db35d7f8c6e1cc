#include "services/controller/following/path_follower.hpp"

#include <gtest/gtest.h>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

const StopLogic kLogic(testing::test_robot(), {});

FollowedPath straight(double length) {
  FollowedPath path;
  path.goal_id = 1;
  path.sequence = 1;
  path.tolerance = 0.1;
  for (double x = 0.0; x <= length + 1e-9; x += 0.25) {
    path.points.emplace_back(x, 0.0);
  }
  return path;
}

const Obstacles kNothing = testing::around();

FollowSituation at(const Pose2& pose, const Obstacles& obstacles = kNothing) {
  FollowSituation situation{.obstacles = obstacles, .world_from_robot = pose};
  situation.is_line_free = [](const Eigen::Vector2d&, const Eigen::Vector2d&) { return true; };
  situation.may_back = true;
  return situation;
}

TEST(PathFollower, StandsStillWithoutAPath) {
  PathFollower follower({}, kLogic);
  const FollowStep step = follower.step(at({}));
  EXPECT_EQ(step.phase, FollowPhase::kNoPath);
  EXPECT_DOUBLE_EQ(step.wanted.linear, 0.0);
}

TEST(PathFollower, DrivesAlongThePathAtFullSpeed) {
  PathFollower follower({}, kLogic);
  follower.set_path(straight(5.0));
  const FollowStep step = follower.step(at({1.0, 0.0, 0.0}));
  EXPECT_EQ(step.phase, FollowPhase::kDriving);
  EXPECT_DOUBLE_EQ(step.wanted.linear, 0.5);
  EXPECT_NEAR(step.wanted.angular, 0.0, 1e-9);
}

TEST(PathFollower, SteersBackToThePath) {
  PathFollower follower({}, kLogic);
  follower.set_path(straight(5.0));
  EXPECT_LT(follower.step(at({1.0, 0.3, 0.0})).wanted.angular, 0.0);
}

TEST(PathFollower, TurnsOnTheSpotWhenThePathLiesBehind) {
  PathFollower follower({}, kLogic);
  follower.set_path(straight(5.0));
  const FollowStep step = follower.step(at({1.0, 0.0, radians(170.0)}));
  EXPECT_EQ(step.phase, FollowPhase::kTurning);
  EXPECT_DOUBLE_EQ(step.wanted.linear, 0.0);
  EXPECT_LT(step.wanted.angular, 0.0);
}

TEST(PathFollower, TurnsTheLongWayRoundWhereTheShortOneIsBlocked) {
  // A post that the rear corner would hit turning right, with room to turn left up to it.
  PathFollower follower({}, kLogic);
  follower.set_path(straight(5.0));
  const Obstacles post = testing::around({testing::obstacle_at(-0.20, 0.285)});
  ASSERT_FALSE(kLogic.is_free({0.0, -1.0}, 1.8, post));
  const FollowStep step = follower.step(at({1.0, 0.0, radians(100.0)}, post));
  if (kLogic.is_free({0.0, 1.0}, 4.5, post)) {
    EXPECT_GT(step.wanted.angular, 0.0);
  } else {
    EXPECT_LT(step.wanted.angular, 0.0);
  }
}

TEST(PathFollower, LetsNoForcePushAgainstAOneWayZone) {
  // Beside the post of a door on the left, with a one-way zone in which headings below -5 degrees lead against it.
  const Obstacles post = testing::around({testing::obstacle_at(0.45, 0.30)});
  const auto heading_in = [&](std::optional<double> lane) {
    PathFollower follower({}, kLogic);
    follower.set_path(straight(5.0));
    FollowSituation situation = at({1.0, 0.0, 0.0}, post);
    situation.lane = lane;
    FollowStep step;
    for (int i = 0; i < 20; ++i) {
      step = follower.step(situation);
    }
    return step.heading_error;
  };
  ASSERT_LT(heading_in({}), radians(-9.0));
  EXPECT_NEAR(heading_in(radians(85.0)), radians(-5.0), radians(0.5));
  EXPECT_EQ(heading_in(radians(-85.0)), heading_in({})) << "with it";
}

TEST(PathFollower, ArrivesAndStaysThroughThePosesNoise) {
  PathFollower follower({}, kLogic);
  follower.set_path(straight(2.0));
  EXPECT_EQ(follower.step(at({1.98, 0.0, 0.1})).phase, FollowPhase::kAtGoal);
  EXPECT_EQ(follower.step(at({1.93, 0.02, 0.1})).phase, FollowPhase::kAtGoal);
  FollowedPath again = straight(2.0);
  again.sequence = 2;
  follower.set_path(again);
  EXPECT_EQ(follower.step(at({1.93, 0.02, 0.1})).phase, FollowPhase::kAtGoal);
  EXPECT_NE(follower.step(at({1.5, 0.0, 0.1})).phase, FollowPhase::kAtGoal);
}

TEST(PathFollower, TakesTheFinalHeadingLast) {
  PathFollower follower({}, kLogic);
  FollowedPath path = straight(2.0);
  path.has_theta = true;
  path.theta = kPi / 2.0;
  path.heading_tolerance = radians(5.0);
  follower.set_path(path);
  const FollowStep turning = follower.step(at({1.99, 0.0, 0.0}));
  EXPECT_EQ(turning.phase, FollowPhase::kTurning);
  EXPECT_GT(turning.wanted.angular, 0.0);
  EXPECT_EQ(follower.step(at({1.99, 0.0, radians(89.0)})).phase, FollowPhase::kAtGoal);
}

TEST(PathFollower, BacksTheLastCentimetresItOvershot) {
  PathFollower follower({}, kLogic);
  follower.set_path(straight(2.0));
  const FollowStep step = follower.step(at({2.2, 0.0, 0.0}));
  EXPECT_LT(step.wanted.linear, 0.0);
}

TEST(PathFollower, StartsAnewWithAnotherGoal) {
  PathFollower follower({}, kLogic);
  follower.set_path(straight(2.0));
  EXPECT_EQ(follower.step(at({2.0, 0.0, 0.0})).phase, FollowPhase::kAtGoal);
  FollowedPath other = straight(4.0);
  other.goal_id = 2;
  follower.set_path(other);
  EXPECT_EQ(follower.step(at({2.0, 0.0, 0.0})).phase, FollowPhase::kDriving);
}

}  // namespace
}  // namespace luminav
