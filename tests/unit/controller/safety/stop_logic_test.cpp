#include "services/controller/safety/stop_logic.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

using testing::around;
using testing::obstacle_at;
using testing::wall;

SenseAges fresh() {
  SenseAges ages;
  ages.odometry = ages.sonar = ages.front_sonar = ages.rear_sonar = 0.1;
  return ages;
}

const RobotDescription kRobot = testing::test_robot();
const StopLogic kLogic(kRobot, {});

TEST(StopLogic, LetsPassWhatIsFree) {
  const StopVerdict verdict = kLogic.judge({0.5, 0.2}, around(), fresh());
  EXPECT_FALSE(verdict.limited);
  EXPECT_DOUBLE_EQ(verdict.twist.linear, 0.5);
  EXPECT_DOUBLE_EQ(verdict.twist.angular, 0.2);
}

TEST(StopLogic, ClampsToTheRobotsLimits) {
  const StopVerdict verdict = kLogic.judge({3.0, -9.0}, around(), fresh());
  EXPECT_DOUBLE_EQ(verdict.twist.linear, kRobot.limits.linear);
  EXPECT_DOUBLE_EQ(verdict.twist.angular, -kRobot.limits.angular);
}

TEST(StopLogic, WalksAndGoesByItsBumperWithoutSonars) {
  SenseAges ages;
  ages.odometry = 0.1;
  ages.has_sonar = false;
  const StopVerdict verdict = kLogic.judge({0.4, 0.2}, around(), ages);
  EXPECT_DOUBLE_EQ(verdict.twist.linear, StopLogicParams{}.bumper_linear);
  EXPECT_DOUBLE_EQ(verdict.twist.angular, 0.1) << "on the same arc";
  EXPECT_TRUE(may_back(ages, {}));
  EXPECT_DOUBLE_EQ(kLogic.judge({-0.1, 0.0}, around(), ages).twist.linear, -0.1);
  const auto ahead = wall({0.29, -0.1}, {0.29, 0.1});
  EXPECT_LT(kLogic.judge({0.2, 0.0}, around(ahead), ages).twist.linear, 0.04) << "a wall of the map";
  ages.front_bumper = true;
  EXPECT_DOUBLE_EQ(kLogic.judge({0.2, 0.0}, around(), ages).twist.linear, 0.0);
}

TEST(StopLogic, StandsWhereTheSonarsOfARobotThatHasThemAreSilent) {
  SenseAges ages;
  ages.odometry = 0.1;
  EXPECT_TRUE(kLogic.judge({0.2, 0.0}, around(), ages).blocked);
  EXPECT_FALSE(may_back(ages, {}));
}

TEST(StopLogic, TurnsBesideTheEdgeOfAZoneThatIsOnlyPossible) {
  const std::vector<Eigen::Vector2d> beside_its_tail{{-0.20, 0.24}};
  for (const ZoneEdge edge : {ZoneEdge::kCertain, ZoneEdge::kPossible}) {
    Obstacles obstacles = around();
    obstacles.set({}, beside_its_tail, 1, edge);
    EXPECT_EQ(kLogic.is_free({0.0, -0.5}, 1.0, obstacles), edge == ZoneEdge::kPossible);
    EXPECT_FALSE(kLogic.is_free({-0.2, -0.5}, 1.0, obstacles)) << "who drives there may touch it";
  }
}

TEST(StopLogic, StopsBeforeAWallAhead) {
  const auto ahead = wall({0.29, -0.1}, {0.29, 0.1});
  const StopVerdict verdict = kLogic.judge({0.5, 0.0}, around(ahead), fresh());
  EXPECT_TRUE(verdict.limited);
  EXPECT_LT(verdict.twist.linear, 0.04);
  EXPECT_NE(verdict.reason.find("ahead"), std::string::npos);
}

TEST(StopLogic, SlowsDownWithTheWayLeft) {
  double last = 0.0;
  for (const double distance : {0.3, 0.4, 0.5, 0.6, 0.9}) {
    const double speed =
        kLogic.judge({0.5, 0.0}, around(wall({distance, -1.0}, {distance, 1.0})), fresh()).twist.linear;
    EXPECT_GE(speed, last);
    // what is left of the way lasts for the time to contact
    EXPECT_LE(speed * StopLogicParams{}.time_to_contact, distance - 0.21 - 0.06 + 0.03);
    last = speed;
  }
  EXPECT_DOUBLE_EQ(last, 0.5);
}

TEST(StopLogic, SeesTheRearCornerSwing) {
  // Beside the rear, outside the outline but inside the circle that the corner sweeps.
  const std::vector<ObstaclePoint> beside{obstacle_at(-0.20, 0.30)};
  EXPECT_GT(kLogic.clearance(around(beside)), 0.08);
  EXPECT_FALSE(kLogic.is_free({0.0, -1.0}, 1.5, around(beside)));
  EXPECT_TRUE(kLogic.is_free({0.3, 0.0}, 1.5, around(beside)));
}

TEST(StopLogic, AlwaysAllowsToLeave) {
  // inside the margin on the front: backing must go, driving on must not
  const auto ahead = wall({0.23, -0.4}, {0.23, 0.4});
  EXPECT_DOUBLE_EQ(kLogic.judge({-0.2, 0.0}, around(ahead), fresh()).twist.linear, -0.2);
  EXPECT_DOUBLE_EQ(kLogic.judge({0.2, 0.0}, around(ahead), fresh()).twist.linear, 0.0);
}

TEST(StopLogic, SlidesAlongAWallItTouchesAlmost) {
  const auto beside = wall({-2.0, 0.23}, {2.0, 0.23});
  EXPECT_DOUBLE_EQ(kLogic.judge({0.3, 0.0}, around(beside), fresh()).twist.linear, 0.3);
}

TEST(StopLogic, TurnsWhereDrivingIsBlocked) {
  const auto ahead = wall({0.32, -0.1}, {0.32, 0.1});
  const StopVerdict verdict = kLogic.judge({0.3, 0.8}, around(ahead), fresh());
  EXPECT_TRUE(verdict.limited);
  EXPECT_LT(verdict.twist.linear, 0.1);
}

TEST(StopLogic, PassesADoorOf90Centimetres) {
  std::vector<ObstaclePoint> door = wall({0.4, 0.45}, {0.6, 0.45}, true);
  for (const ObstaclePoint& point : wall({0.4, -0.45}, {0.6, -0.45}, true)) {
    door.push_back(point);
  }
  EXPECT_FALSE(kLogic.judge({0.3, 0.0}, around(door), fresh()).limited);
  EXPECT_FALSE(kLogic.judge({0.3, 0.2}, around(door), fresh()).limited);
}

TEST(StopLogic, StopsEarlierForSomebodyWhoComes) {
  std::vector<ObstaclePoint> somebody{obstacle_at(1.25, 0.0)};
  EXPECT_FALSE(kLogic.judge({0.5, 0.0}, around(somebody), fresh()).limited);
  somebody[0].approach = 0.8;
  somebody[0].age = 0.3;
  EXPECT_LT(kLogic.judge({0.5, 0.0}, around(somebody), fresh()).twist.linear, 0.4);
  somebody[0].position.x() = 0.7;
  EXPECT_LT(kLogic.judge({0.5, 0.0}, around(somebody), fresh()).twist.linear, 0.05);
}

TEST(StopLogic, StopsWhenASenseFallsSilent) {
  SenseAges ages = fresh();
  ages.odometry = 0.6;
  EXPECT_TRUE(kLogic.judge({0.3, 0.3}, around(), ages).blocked);
  ages = fresh();
  ages.sonar = 0.6;
  const StopVerdict verdict = kLogic.judge({0.3, 0.3}, around(), ages);
  EXPECT_DOUBLE_EQ(verdict.twist.linear, 0.0);
  EXPECT_DOUBLE_EQ(verdict.twist.angular, 0.0);
  EXPECT_NE(verdict.reason.find("sonar"), std::string::npos);
}

TEST(StopLogic, DoesNotBackWhereNothingLooks) {
  SenseAges ages = fresh();
  ages.rear_sonar = 1e9;
  const StopVerdict verdict = kLogic.judge({-0.2, 0.3}, around(), ages);
  EXPECT_DOUBLE_EQ(verdict.twist.linear, 0.0);
  EXPECT_DOUBLE_EQ(verdict.twist.angular, 0.3);
  EXPECT_DOUBLE_EQ(kLogic.judge({0.2, 0.3}, around(), ages).twist.linear, 0.2);
}

TEST(StopLogic, DoesNotPushAgainstAPressedBumper) {
  SenseAges ages = fresh();
  ages.front_bumper = true;
  EXPECT_DOUBLE_EQ(kLogic.judge({0.2, 0.0}, around(), ages).twist.linear, 0.0);
  EXPECT_DOUBLE_EQ(kLogic.judge({-0.2, 0.0}, around(), ages).twist.linear, -0.2);
}

TEST(StopLogic, NeverLetsTheOutlineTouchWhateverIsWished) {
  // Drive random wishes for a second each through random posts; standing posts are never touched.
  std::mt19937 random(42);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  std::uniform_real_distribution<double> linear(-0.5, 0.5);
  std::uniform_real_distribution<double> angular(-1.0, 1.0);
  const Footprint footprint(kRobot.footprint);
  for (int round = 0; round < 200; ++round) {
    std::vector<ObstaclePoint> posts;
    while (posts.size() < 12) {
      const ObstaclePoint post = obstacle_at(place(random), place(random));
      if (footprint.distance(post.position) > 0.08) {
        posts.push_back(post);
      }
    }
    Pose2 robot;
    for (int second = 0; second < 3; ++second) {
      const DriveTwist wanted{linear(random), angular(random)};
      for (int step = 0; step < 25; ++step) {
        std::vector<ObstaclePoint> seen = posts;
        for (ObstaclePoint& post : seen) {
          post.position = robot.inverse() * post.position;
        }
        robot = robot * drive_arc(kLogic.judge(wanted, around(seen), fresh()).twist, 0.04);
        for (const ObstaclePoint& post : posts) {
          ASSERT_GT(footprint.distance(robot.inverse() * post.position), 0.03);
        }
      }
    }
  }
}

TEST(JudgeDiscAges, TakesTheOldestOfEachSide) {
  EchoMemory memory(kRobot.sonar, {});
  SenseAges ages;
  judge_disc_ages(memory, 5'000'000, ages);
  EXPECT_GT(ages.sonar, 1e6);
  for (std::size_t disc = 0; disc < 16; ++disc) {
    memory.add({disc, 4'000'000 + 10'000 * static_cast<std::int64_t>(disc), 5.0, false, {}}, {});
  }
  judge_disc_ages(memory, 5'000'000, ages);
  EXPECT_NEAR(ages.sonar, 0.85, 1e-9);
  EXPECT_NEAR(ages.front_sonar, 0.98, 1e-9);
  EXPECT_NEAR(ages.rear_sonar, 0.90, 1e-9);
}

}  // namespace
}  // namespace luminav
