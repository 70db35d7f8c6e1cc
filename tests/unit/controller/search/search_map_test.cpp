#include "services/controller/search/search_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

using testing::test_robot;

struct Wall {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

/// A room of 4 m x 3 m whose south wall may have a doorway of 1 m to a corridor 2 m wide.
std::vector<Wall> room(bool has_doorway) {
  std::vector<Wall> walls{{{0, 0}, {0, 3}}, {{0, 3}, {4, 3}}, {{4, 3}, {4, 0}}};
  if (has_doorway) {
    walls.insert(walls.end(), {{{0, 0}, {1.3, 0}}, {{2.3, 0}, {4, 0}}, {{-4, -2}, {8, -2}}});
  } else {
    walls.push_back({{0, 0}, {4, 0}});
  }
  return walls;
}

double range_along(const Eigen::Vector2d& from, double theta, const std::vector<Wall>& walls) {
  const Eigen::Vector2d along(std::cos(theta), std::sin(theta));
  double nearest = 5.0;
  for (const Wall& wall : walls) {
    Eigen::Matrix2d system;
    system << along, wall.from - wall.to;
    if (std::abs(system.determinant()) < 1e-9) {
      continue;
    }
    const Eigen::Vector2d solution = system.inverse() * (wall.from - from);
    if (solution.x() > 0.0 && solution.y() >= 0.0 && solution.y() <= 1.0) {
      nearest = std::min(nearest, solution.x());
    }
  }
  return nearest;
}

class SearchMapTest : public ::testing::Test {
 protected:
  /// All discs fire once from a pose; a cone hears what is nearest in it.
  void scan(const Pose2& odom_from_robot, const std::vector<Wall>& walls) {
    utime_ += 320'000;
    std::vector<SonarFiring> firings;
    for (std::size_t disc = 0; disc < robot_.sonar.robot_from_sonar.size(); ++disc) {
      const Pose2 odom_from_sonar = odom_from_robot * robot_.sonar.robot_from_sonar[disc];
      double range = 5.0;
      for (int i = -7; i <= 7; ++i) {
        range =
            std::min(range, range_along(odom_from_sonar.position(), odom_from_sonar.theta + radians(2.0 * i), walls));
      }
      firings.push_back({disc, utime_, range, range < 4.9, odom_from_robot});
    }
    map_.visit(odom_from_robot.position());
    map_.add(firings);
  }

  /// Drives a round through the room, half a metre off its walls.
  void look_round(const std::vector<Wall>& walls) {
    for (int i = 0; i <= 30; ++i) {
      const double x = 0.5 + 0.1 * i;
      scan({x, 0.6, 0.0}, walls);
      scan({x, 1.5, kPi}, walls);
      scan({x, 2.4, kPi}, walls);
    }
    for (int i = 0; i <= 10; ++i) {
      scan({1.8, 1.6 - 0.1 * i, -0.5 * kPi}, walls);
    }
  }

  RobotDescription robot_ = test_robot();
  SearchMap map_{robot_.sonar};
  std::int64_t utime_ = 0;
};

TEST_F(SearchMapTest, KnowsNoWayBeforeItHasSeenAnything) {
  EXPECT_FALSE(map_.path_to_new_ground({0.0, 0.0}));
}

TEST_F(SearchMapTest, LeavesAKnownRoomByItsDoorway) {
  look_round(room(true));
  const auto path = map_.path_to_new_ground({1.0, 2.0});
  ASSERT_TRUE(path);
  EXPECT_LT(path->back().y(), -0.3) << "new ground is outside";
  EXPECT_NEAR(path->front().x(), 1.0, 0.5) << "the way begins at the robot";
  for (const Eigen::Vector2d& place : *path) {
    if (std::abs(place.y()) < 0.1) {
      EXPECT_GT(place.x(), 1.4);
      EXPECT_LT(place.x(), 2.2);
    }
  }
}

TEST_F(SearchMapTest, FindsNothingNewInAClosedRoomThatItKnows) {
  look_round(room(false));
  EXPECT_FALSE(map_.path_to_new_ground({1.0, 2.0}));
}

TEST_F(SearchMapTest, DoesNotTakeAWallForOpenThatIsSilentAtASlant) {
  look_round(room(false));
  // what is heard at a slant is the wall's mirror image, a metre behind it
  for (int i = 0; i < 40; ++i) {
    utime_ += 320'000;
    map_.add(std::vector<SonarFiring>{{7, utime_, 2.2, true, {0.5 + 0.05 * i, 0.8, radians(40.0)}}});
  }
  EXPECT_FALSE(map_.path_to_new_ground({1.0, 2.0}));
}

TEST_F(SearchMapTest, GivesUpAPlaceThatCouldNotBeReached) {
  look_round(room(true));
  const auto path = map_.path_to_new_ground({1.0, 2.0});
  ASSERT_TRUE(path);
  map_.block(path->back());
  const auto other = map_.path_to_new_ground({1.0, 2.0});
  if (other) {
    EXPECT_GT((other->back() - path->back()).norm(), 0.4);
  }
}

TEST_F(SearchMapTest, FindsNoWayThroughWhatWasShutUntilThatFades) {
  look_round(room(true));
  ASSERT_TRUE(map_.path_to_new_ground({1.0, 2.0}));
  map_.shut({1.6, 0.0});
  map_.shut({2.0, 0.0});
  EXPECT_FALSE(map_.path_to_new_ground({1.0, 2.0}));
  EXPECT_EQ(map_.ground_at({1.8, 0.0}), Ground::kStands) << "though the sonars hear nothing there";
  for (int i = 0; i < SearchMap::kShutFor; ++i) {
    EXPECT_FALSE(map_.path_to_new_ground({1.0, 2.0}));
    map_.fade();
  }
  EXPECT_TRUE(map_.path_to_new_ground({1.0, 2.0}));
}

TEST_F(SearchMapTest, OpensWhatWasShutWhereTheRobotHasComeThrough) {
  look_round(room(true));
  map_.shut({1.8, 0.0});
  map_.visit({1.8, 0.0});
  EXPECT_EQ(map_.ground_at({1.8, 0.0}), Ground::kFree);
}

TEST_F(SearchMapTest, SeesThatAnObstacleWentAway) {
  std::vector<Wall> walls = room(true);
  walls.push_back({{1.2, 0.05}, {2.4, 0.05}});  // somebody shut the door
  look_round(walls);
  EXPECT_FALSE(map_.path_to_new_ground({1.0, 2.0}));
  look_round(room(true));
  look_round(room(true));
  EXPECT_TRUE(map_.path_to_new_ground({1.0, 2.0}));
}

TEST_F(SearchMapTest, FadesWhatItDoesNotHearAgain) {
  look_round(room(false));
  const auto look_once = [&] { scan({1.8, 1.0, -0.5 * kPi}, room(true)); };
  look_once();
  EXPECT_EQ(map_.ground_at({1.8, 0.0}), Ground::kStands);
  for (int i = 0; i < 6; ++i) {
    map_.fade();
  }
  EXPECT_EQ(map_.ground_at({1.8, 0.0}), Ground::kUnknown);
  EXPECT_EQ(map_.ground_at({1.8, 1.0}), Ground::kFree) << "what was free stays so";
  look_once();
  EXPECT_EQ(map_.ground_at({1.8, 0.0}), Ground::kFree);
}

TEST_F(SearchMapTest, TakesUpFiringsOfAnEarlierClockOnceItIsCleared) {
  utime_ = 3'600'000'000;
  look_round(room(true));
  map_.clear();
  utime_ = 0;
  scan({1.8, 1.0, -0.5 * kPi}, room(true));
  EXPECT_EQ(map_.ground_at({1.8, 0.5}), Ground::kFree);
}

TEST_F(SearchMapTest, GoesAlongWithTheRobotAndKeepsWhatIsNear) {
  look_round(room(true));
  const auto grounds = [&] {
    std::vector<Ground> result;
    for (double x = -0.95; x < 5.0; x += 0.1) {
      for (double y = -2.95; y < 4.0; y += 0.1) {
        result.push_back(map_.ground_at({x, y}));
      }
    }
    return result;
  };
  const std::vector<Ground> at_first = grounds();
  Eigen::Vector2d place(6.0, -3.5);
  for (; place.x() < 14.0; place += Eigen::Vector2d(0.25, -0.1)) {
    map_.visit(place);
    EXPECT_EQ(grounds() == at_first, true) << "the room is still there, from " << place.transpose();
    EXPECT_TRUE(map_.is_near_trail({1.8, 1.5}));
  }
  const Eigen::Vector2d step(0.25, -0.1);
  for (; place.x() < 60.0; place += step) {
    map_.visit(place);
    ASSERT_TRUE(map_.is_near_trail(place + 4.0 * step)) << "around it there is nothing new, at " << place.transpose();
    ASSERT_TRUE(map_.is_near_trail(place - 30.0 * step)) << "nor where it was, at " << place.transpose();
  }
  EXPECT_FALSE(map_.is_near_trail({1.8, 1.5})) << "so far away nothing is kept";
}

/// Drives straight on by steps of 5 cm, between walls that are nearer than what it knows around its trail.
class LongSearchMapTest : public SearchMapTest {
 protected:
  void drive(const Eigen::Vector2d& direction, double metres, double room_at_left = 0.9) {
    const double theta = std::atan2(direction.y(), direction.x());
    for (int i = 0; i < static_cast<int>(std::lround(20.0 * metres)); ++i) {
      place_ += 0.05 * direction;
      map_.visit(place_);
      utime_ += 100'000;
      const Pose2 pose{place_.x(), place_.y(), theta};
      map_.add(std::vector<SonarFiring>{{0, utime_, room_at_left, true, pose}, {7, utime_, 0.9, true, pose}});
    }
  }

  Eigen::Vector2d place_{0.0, 0.0};
};

TEST_F(LongSearchMapTest, SearchesOnlyInsideAfterItWentAlong) {
  for (const Eigen::Vector2d& direction : {Eigen::Vector2d(0, 1), {0, -1}, {1, 0}, {-1, 0}}) {
    map_.clear();
    for (int metre = 1; metre <= 60; ++metre) {
      drive(direction, 1.0);
      ASSERT_FALSE(map_.path_to_new_ground(place_)) << metre << " m along " << direction.transpose();
    }
  }
}

TEST_F(LongSearchMapTest, BlocksAPlaceAtTheMapsEdge) {
  drive({1.0, 0.0}, 4.0);
  drive({1.0, 0.0}, 2.0, 2.4);
  ASSERT_TRUE(map_.path_to_new_ground(place_));
  int metres = 0;
  for (auto path = map_.path_to_new_ground(place_); path; path = map_.path_to_new_ground(place_), ++metres) {
    ASSERT_LT(metres, 60) << "so far away nothing is kept";
    SearchMap blocked = map_;
    blocked.block(path->back());
    ASSERT_TRUE(blocked.is_near_trail(path->back())) << metres << " m on, at " << path->back().transpose();
    drive({1.0, 0.0}, 1.0);
  }
  EXPECT_GT(metres, 10);
}

}  // namespace
}  // namespace luminav
