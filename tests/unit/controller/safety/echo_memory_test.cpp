#include "services/controller/safety/echo_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStart = 1'000'000'000;  // [us]
constexpr std::size_t kAhead = 3;               // the disc 10 degrees to the left

class EchoMemoryTest : public ::testing::Test {
 protected:
  void fire(double at, std::size_t disc, double range, const Pose2& place = {}, const WallTest& is_wall = {}) {
    memory_.add({disc, time(at), range, range < 5.0, place}, is_wall);
  }
  [[nodiscard]] std::vector<ObstaclePoint> at(double seconds, const Pose2& place = {}) const {
    return memory_.obstacles(time(seconds), place);
  }
  /// Distance [m] from the disc ahead to the nearest echo, after a number of firings, each 0.15 m farther on. They
  /// measure 1 m and `other` in turn.
  [[nodiscard]] static double nearest_ahead_after(int firings, double other) {
    const SonarRing ring = testing::test_robot().sonar;
    EchoMemory memory{ring, {}};
    Pose2 place;
    std::int64_t now = kStart;
    for (int i = 0; i <= firings; ++i) {
      now = time(0.32 * i);
      place = {0.15 * i, 0.0, 0.0};
      memory.add({kAhead, now, i % 2 == 0 ? 1.0 : other, true, place}, {});
    }
    double nearest = 9.0;
    for (const ObstaclePoint& point : memory.obstacles(now, place)) {
      nearest = std::min(nearest, (point.position - ring.robot_from_sonar[kAhead].position()).norm());
    }
    return nearest;
  }
  static std::int64_t time(double seconds) { return kStart + static_cast<std::int64_t>(1e6 * seconds); }

  EchoMemory memory_{testing::test_robot().sonar, {}};
};

TEST_F(EchoMemoryTest, PutsAnEchoAtItsRangeFromTheDisc) {
  fire(0.0, kAhead, 1.0);
  const std::vector<ObstaclePoint> points = at(0.0);
  ASSERT_FALSE(points.empty());
  const Pose2 disc = testing::test_robot().sonar.robot_from_sonar[kAhead];
  for (const ObstaclePoint& point : points) {
    EXPECT_NEAR((point.position - disc.position()).norm(), 1.0, 1e-9);
  }
}

TEST_F(EchoMemoryTest, KeepsOnlyThePartOfAnArcThatNoNeighbourIsNearerTo) {
  fire(0.0, kAhead, 1.0);
  const Pose2 disc = testing::test_robot().sonar.robot_from_sonar[kAhead];
  double min = 9.0;
  double max = -9.0;
  for (const ObstaclePoint& point : at(0.0)) {
    const Eigen::Vector2d offset = point.position - disc.position();
    const double angle = degrees(std::atan2(offset.y(), offset.x()));
    min = std::min(min, angle);
    max = std::max(max, angle);
  }
  EXPECT_NEAR(min, 0.0, 1e-6);
  EXPECT_NEAR(max, 20.0, 1e-6);
}

TEST_F(EchoMemoryTest, CarriesEchoesAlongWithTheRobot) {
  fire(0.0, kAhead, 1.0);
  const Eigen::Vector2d before = at(0.0).front().position;
  const Eigen::Vector2d after = at(0.3, {0.2, 0.0, 0.0}).front().position;
  EXPECT_NEAR(before.x() - after.x(), 0.2, 1e-9);
  EXPECT_NEAR(before.y(), after.y(), 1e-9);
}

TEST_F(EchoMemoryTest, ForgetsAfterItsTimeButLaterWhereSonarMayBeBlind) {
  fire(0.0, kAhead, 1.0);
  EXPECT_FALSE(at(1.1).empty());
  EXPECT_TRUE(at(1.3).empty());
  EXPECT_FALSE(memory_.remembered(time(7.0), {}).empty());
  fire(2.0, kAhead, 0.3);
  EXPECT_FALSE(at(4.0).empty());
  EXPECT_TRUE(at(4.6).empty());
}

// Seen in a contact: all discs stuck with somebody a metre ahead, and the robot drove on for the 0.6 m until it was
// noticed.
TEST_F(EchoMemoryTest, KeepsWhatADiscHeardThatRepeatsItselfOnTheWayTowardsIt) {
  const double nearest_alone = nearest_ahead_after(5, 1.0);
  EXPECT_NEAR(nearest_alone, 1.0 - 5 * 0.15, 0.03);
  EXPECT_GT(nearest_ahead_after(5, 1.02), nearest_alone + 0.3);  // it has gone on: that is farther, each time anew
}

TEST_F(EchoMemoryTest, WithoutAMapRemembersLongerWhatIsNear) {
  fire(0.0, kAhead, 0.3);
  fire(0.0, kAhead + 1, 1.0);
  EXPECT_TRUE(at(5.0).empty());
  const auto points = memory_.obstacles_without_map(time(5.0), {});
  ASSERT_FALSE(points.empty());
  for (const ObstaclePoint& point : points) {
    EXPECT_LT(point.position.x(), 0.6);
  }
  EXPECT_TRUE(memory_.obstacles_without_map(time(9.0), {}).empty());
}

// The robot stands with a box beside its rear corner, turns so that no disc hears it, waits, and turns on.
TEST_F(EchoMemoryTest, KeepsWhatStandsNearThoughItFallsSilent) {
  fire(0.0, kAhead, 0.3);
  fire(1.0, kAhead, 0.3);
  fire(2.0, kAhead, 5.0, {0.0, 0.0, radians(15.0)});
  EXPECT_FALSE(at(7.0).empty());
  EXPECT_TRUE(at(9.5).empty());
  fire(20.0, kAhead, 0.3);  // heard but once: it may have gone
  EXPECT_TRUE(at(23.0).empty());
}

// Somebody stood beside a robot that turned a little meanwhile, and went away.
TEST_F(EchoMemoryTest, TakesWhatStoodForGoneWhereTheSameThingWasHeardAndIsNotHeardAnyMore) {
  const Pose2 turned{0.0, 0.0, radians(8.0)};
  fire(0.0, kAhead, 0.3);
  fire(1.0, kAhead, 0.3);
  fire(2.0, kAhead, 0.3, turned);
  fire(2.5, kAhead, 5.0, turned);
  EXPECT_FALSE(memory_.obstacles_without_map(time(3.0), turned).empty()) << "for a while it may have been an error";
  EXPECT_TRUE(at(4.0, turned).empty());
  EXPECT_TRUE(memory_.obstacles_without_map(time(4.0), turned).empty());
}

TEST_F(EchoMemoryTest, TellsWhatStandsFromWhatWalks) {
  fire(0.0, kAhead, 1.5);
  EXPECT_FALSE(at(0.0).back().has_stood);
  fire(0.32, kAhead, 1.5);
  EXPECT_FALSE(at(0.32).back().has_stood);
  fire(0.64, kAhead, 1.4, {0.1, 0.0, 0.0});
  EXPECT_TRUE(at(0.64, {0.1, 0.0, 0.0}).back().has_stood);
  fire(0.96, kAhead, 1.0, {0.1, 0.0, 0.0});
  EXPECT_FALSE(at(0.96, {0.1, 0.0, 0.0}).back().has_stood);
}

TEST_F(EchoMemoryTest, AFartherEchoTakesBackANearerOne) {
  fire(0.0, kAhead, 1.0);
  fire(0.32, kAhead, 2.5);
  for (const ObstaclePoint& point : at(0.32)) {
    EXPECT_GT(point.position.norm(), 2.0);
  }
}

TEST_F(EchoMemoryTest, AFartherEchoLeavesAPostAtTheEdgeOfItsCone) {
  // the disc that looks to the left has no neighbour behind it: what it hears there may be a door's post
  constexpr std::size_t kLeft = 0;
  const Pose2 turned{0.0, 0.0, radians(1.0)};
  fire(0.0, kLeft, 0.3);
  fire(0.32, kLeft, 1.5, turned);
  const Pose2 disc = testing::test_robot().sonar.robot_from_sonar[kLeft];
  const auto points = at(0.32, turned);
  const auto near = [&](const ObstaclePoint& p) { return (p.position - disc.position()).norm() < 0.4; };
  ASSERT_TRUE(std::any_of(points.begin(), points.end(), near));
  for (const ObstaclePoint& point : points) {
    const Eigen::Vector2d seen = disc.inverse() * point.position;
    EXPECT_TRUE(!near(point) || std::abs(std::atan2(seen.y(), seen.x())) > radians(11.0))
        << "what lies ahead of the disc was heard to be gone";
  }
}

TEST_F(EchoMemoryTest, SilenceTakesBackOnlyWhatTheSameDiscHeardFromTheSamePlace) {
  fire(0.0, kAhead, 1.0);
  fire(0.32, kAhead, 5.0, {0.3, 0.0, 0.0});
  EXPECT_FALSE(at(0.32).empty());
  fire(0.64, kAhead, 5.0);
  EXPECT_TRUE(at(0.64).empty());
}

TEST_F(EchoMemoryTest, AnEchoFromAnotherDirectionRefutesNothing) {
  // a smooth wall seen at a slant mirrors: it reads too long and says nothing of what stood square on
  fire(0.0, kAhead, 1.0);
  fire(0.32, kAhead, 3.0, {0.0, 0.0, radians(40.0)});
  const auto points = at(0.32);
  EXPECT_TRUE(
      std::any_of(points.begin(), points.end(), [](const ObstaclePoint& p) { return p.position.norm() < 1.3; }));
}

TEST_F(EchoMemoryTest, BelievesInSomebodyWhoComesNearerTwiceRunning) {
  fire(0.0, kAhead, 3.0);
  fire(0.32, kAhead, 2.74);
  EXPECT_DOUBLE_EQ(at(0.32).back().approach, 0.0);
  fire(0.64, kAhead, 2.48);
  EXPECT_NEAR(at(0.64).back().approach, 0.26 / 0.32, 0.01);
}

TEST_F(EchoMemoryTest, ItsOwnMotionIsNoApproach) {
  for (int i = 0; i < 4; ++i) {
    fire(0.32 * i, kAhead, 3.0 - 0.16 * i, {0.16 * i, 0.0, 0.0});
  }
  for (const ObstaclePoint& point : at(0.96, {0.48, 0.0, 0.0})) {
    EXPECT_DOUBLE_EQ(point.approach, 0.0);
  }
}

TEST_F(EchoMemoryTest, AMappedPostExplainsAnEchoAndLeavesTheDoorwayOpen) {
  // a wall to the left of the cone's edge only
  const WallTest is_wall = [](const Eigen::Vector2d& point, double distance) { return point.y() > 0.45 - distance; };
  fire(0.0, kAhead, 1.0, {}, is_wall);
  const auto points = at(0.0);
  ASSERT_FALSE(points.empty());
  for (const ObstaclePoint& point : points) {
    EXPECT_TRUE(point.is_known);
    EXPECT_GT(point.position.y(), 0.29);
  }
}

TEST_F(EchoMemoryTest, IgnoresRepeatedStampsAndDiscsThatDoNotExist) {
  fire(0.0, kAhead, 1.0);
  fire(0.0, kAhead, 0.2);
  fire(0.1, 99, 0.2);
  for (const ObstaclePoint& point : at(0.1)) {
    EXPECT_GT(point.position.norm(), 0.9);
  }
}

TEST_F(EchoMemoryTest, ClearsWhenTheOdometryJumps) {
  fire(0.0, kAhead, 1.0);
  memory_.clear();
  EXPECT_TRUE(at(0.0).empty());
  EXPECT_EQ(memory_.newest()[kAhead].utime, 0);
}

}  // namespace
}  // namespace luminav
