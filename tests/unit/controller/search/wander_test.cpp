#include "services/controller/search/wander.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

using testing::test_robot;
using testing::wall;

// indices of the robot's discs
constexpr std::size_t kBehindRight = 10;                 // -150 degrees
constexpr std::size_t kBehindLeft = 13;                  // 150 degrees
const std::vector<std::size_t> kStraightBehind{11, 12};  // 170 degrees to either side

/// Without the building's file, and leaving for new ground at once.
class WanderTest : public ::testing::Test {
 protected:
  static WanderParams params() {
    WanderParams result;
    result.look_around = -1.0;
    result.plan_every = 0.0;
    return result;
  }

  /// A step 0.05 s after the last one.
  DriveTwist step(const Pose2& pose = {}, const std::vector<ObstaclePoint>& things = {}) {
    return step_of(wander_, pose, things);
  }
  DriveTwist step_of(Wander& wander, const Pose2& pose, const std::vector<ObstaclePoint>& things) {
    now_ += 50'000;
    const Obstacles obstacles(stop_logic_.footprint(), things);
    return wander.step({now_, pose, obstacles, things, firings_, {}});
  }
  /// These discs hear something at a range [m], thrice; the robot stands at the origin meanwhile.
  void hear(const std::vector<std::size_t>& discs, double range) {
    for (int i = 0; i < 3; ++i) {
      firings_.clear();
      for (const std::size_t disc : discs) {
        firings_.push_back({disc, now_ + 50'000, range, true, {}});
      }
      step();
    }
    firings_.clear();
  }

  RobotDescription robot_ = test_robot();
  StopLogic stop_logic_{robot_, {}};
  Wander wander_{params(), robot_.sonar, stop_logic_, {}};
  std::vector<SonarFiring> firings_;
  std::int64_t now_ = 1'000'000;
};

/// A corridor 1 m wide that ends half a metre ahead.
std::vector<ObstaclePoint> dead_end() {
  std::vector<ObstaclePoint> things = wall({0.5, -0.5}, {0.5, 0.5});
  for (const double side : {-0.5, 0.5}) {
    const std::vector<ObstaclePoint> along = wall({-3.5, side}, {0.5, side});
    things.insert(things.end(), along.begin(), along.end());
  }
  return things;
}

TEST_F(WanderTest, TurnsOnTheSpotForAWayBehindIt) {
  hear(kStraightBehind, 2.4);
  Pose2 pose;
  double off = kPi;
  for (int i = 0; i < 200 && off > radians(10.0); ++i) {
    const DriveTwist twist = step(pose);
    if (off > radians(35.0)) {
      ASSERT_DOUBLE_EQ(twist.linear, 0.0) << degrees(off) << " degrees off";
      ASSERT_DOUBLE_EQ(std::abs(twist.angular), params().angular) << degrees(off) << " degrees off";
    }
    pose.theta = wrap_angle(pose.theta + 0.05 * twist.angular);
    off = std::abs(wrap_angle(kPi - pose.theta));
  }
  EXPECT_LE(off, radians(10.0));
  EXPECT_GT(step(pose).linear, 0.0);
}

TEST_F(WanderTest, KeepsTheWayRoundItBegan) {
  hear(kStraightBehind, 2.4);
  const double angular = step({0.0, 0.0, 0.1}).angular;
  ASSERT_NE(angular, 0.0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_DOUBLE_EQ(step({0.0, 0.0, i % 2 == 0 ? 0.1 : -0.1}).angular, angular);
  }
}

TEST_F(WanderTest, ChoosesTheWayRoundAnewForAnotherPlace) {
  hear({kBehindLeft}, 2.4);
  ASSERT_GT(step().angular, 0.0);
  hear({kBehindRight}, 2.4);
  hear({kBehindLeft}, 1.0);  // a door was shut
  EXPECT_LT(step().angular, 0.0);
}

TEST_F(WanderTest, GivesUpATurn) {
  const std::vector<ObstaclePoint> ahead = wall({0.5, -0.4}, {0.5, 0.4});
  step({}, ahead);
  const double angular = step({}, ahead).angular;
  ASSERT_NE(angular, 0.0);
  wander_.give_up(now_, {});
  step({}, ahead);
  EXPECT_LT(step({}, ahead).angular * angular, 0.0) << "the other way round is as good, and has not failed";
}

TEST_F(WanderTest, GoesElsewhereAfterTwelveSecondsWithoutComingNearer) {
  hear(kStraightBehind, 2.4);
  int steps = 0;  // of somebody who holds it where it stands
  while (steps < 20 * 120 && step().linear == 0.0) {
    ++steps;
  }
  EXPECT_GT(0.05 * steps, 11.8);
  EXPECT_LT(0.05 * steps, 61.0) << "there is half a metre more behind each place that it could not reach";
}

TEST_F(WanderTest, ExploresWhereItKnowsNoWay) {
  for (int i = 0; i < 20; ++i) {
    const DriveTwist twist = step();
    EXPECT_DOUBLE_EQ(twist.linear, params().speed);
    EXPECT_DOUBLE_EQ(twist.angular, 0.0);
  }
}

TEST_F(WanderTest, TakesTheLongWayRoundIfOnlyThatIsFree) {
  std::vector<ObstaclePoint> things = dead_end();
  step({}, things);
  EXPECT_GT(step({}, things).angular, 0.0);
  wander_.clear();
  things.push_back(testing::obstacle_at(0.0, -0.40));  // a rear corner would swing into it
  step({}, things);
  EXPECT_LT(step({}, things).angular, 0.0);
}

TEST_F(WanderTest, TurnsTheLongWayRoundToItsWayIfOnlyThatIsFree) {
  hear({kBehindLeft}, 2.4);
  ASSERT_GT(step().angular, 0.0);
  step({0.0, 0.0, radians(150.0)});  // it has turned there
  const std::vector<ObstaclePoint> things{testing::obstacle_at(-0.137, -0.376)};
  ASSERT_FALSE(stop_logic_.is_free({0.0, 0.5}, 3.0, testing::around(things))) << "a rear corner would swing into it";
  for (double theta = 0.0; theta > -150.0; theta -= 10.0) {
    EXPECT_LT(step({0.0, 0.0, radians(theta)}, things).angular, 0.0) << theta;
  }
}

TEST_F(WanderTest, SaysWhatIsLeftOfATurn) {
  EXPECT_DOUBLE_EQ(wander_.turn_left(), 0.0);
  hear({kBehindLeft}, 2.4);
  EXPECT_NEAR(wander_.turn_left(), radians(150.0), radians(12.0));
  step({0.0, 0.0, radians(145.0)});
  EXPECT_DOUBLE_EQ(wander_.turn_left(), 0.0);
}

TEST_F(WanderTest, ForgetsAllOnClear) {
  const auto drive = [&](Wander& wander) {
    now_ = 1'000'000;
    std::vector<DriveTwist> twists;
    Pose2 pose;
    for (int i = 0; i < 120; ++i) {
      firings_.clear();
      for (const std::size_t disc : kStraightBehind) {
        firings_.push_back({disc, now_, 2.4, true, pose});
      }
      twists.push_back(step_of(wander, pose, i < 40 ? dead_end() : std::vector<ObstaclePoint>{}));
      pose = pose * drive_arc(twists.back(), 0.05);
    }
    return twists;
  };
  const std::vector<DriveTwist> first = drive(wander_);
  now_ = 3'600'000'000;
  hear({kBehindLeft}, 2.4);
  step({}, dead_end());
  wander_.give_up(now_, {});
  wander_.clear();
  const std::vector<DriveTwist> again = drive(wander_);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_DOUBLE_EQ(again[i].linear, first[i].linear) << i;
    ASSERT_DOUBLE_EQ(again[i].angular, first[i].angular) << i;
  }
}

}  // namespace
}  // namespace luminav
