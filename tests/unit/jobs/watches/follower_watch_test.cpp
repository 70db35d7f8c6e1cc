#include "services/jobs/watches/follower_watch.hpp"

#include <gtest/gtest.h>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr double kCone = radians(15.0);

/// A robot that drives, and an echo from a disc that looks in some direction.
class Robot {
 public:
  explicit Robot(std::shared_ptr<const PriorMap> walls = nullptr) : watch(FollowerParams{}, std::move(walls)) {}

  void drive(double distance) {
    for (double left = distance; left > 1e-9; left -= 0.1) {
      pose = pose * Pose2{0.1, 0.0, 0.0};
      watch.update({}, 0.2, 0.1, pose);
    }
  }
  void turn(double angle) { pose = pose * Pose2{0.0, 0.0, angle}; }
  /// `direction` [rad] of the disc in the robot.
  bool hear(double direction, double range, double seconds = 0.2) {
    return watch.update({{pose * Pose2{0.0, 0.0, direction}, kCone, range}}, seconds, 0.0, pose);
  }

  FollowerWatch watch;
  Pose2 pose{};
};

/// A wall of 0.2 m across the way at x = 5 m, with a door of 0.9 m.
std::shared_ptr<const PriorMap> wall_with_door() {
  PriorMap map{{0.1, {-2.0, -4.0}, 120, 80}, {}};
  map.cells.assign(map.geometry.size(), Prior::kFree);
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (const int column : {70, 71}) {
      const Cell cell{column, row};
      if (std::abs(map.geometry.centre_of(cell).y()) > 0.45) {
        map.cells[map.geometry.index(cell)] = Prior::kOccupied;
      }
    }
  }
  return std::make_shared<const PriorMap>(std::move(map));
}

TEST(FollowerWatch, BelievesInWhomItHearsTwice) {
  Robot robot;
  robot.drive(3.0);
  EXPECT_NEAR(robot.watch.alone(), 3.0, 1e-9);
  EXPECT_FALSE(robot.hear(kPi, 0.8));
  EXPECT_TRUE(robot.hear(kPi, 0.9));
  EXPECT_EQ(robot.watch.alone(), 0.0);
}

TEST(FollowerWatch, BelievesInNoSingleEcho) {
  Robot robot;
  robot.drive(3.0);
  EXPECT_FALSE(robot.hear(kPi, 0.8));
  EXPECT_FALSE(robot.hear(kPi, 0.8, 1.5)) << "too long ago";
  EXPECT_FALSE(robot.hear(kPi, 1.45)) << "elsewhere";
  EXPECT_NEAR(robot.watch.alone(), 3.0, 1e-9);
}

TEST(FollowerWatch, HearsNobodyBeyondItsReachOrBesideItsWay) {
  Robot robot;
  robot.drive(3.0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(robot.hear(kPi, 1.6));
    EXPECT_FALSE(robot.hear(radians(130.0), 0.8));
    EXPECT_FALSE(robot.hear(0.0, 0.8)) << "it has not been there yet";
  }
}

TEST(FollowerWatch, HearsHimAllRound) {
  Robot robot;
  robot.drive(3.0);
  robot.turn(0.5 * kPi);
  robot.drive(0.3);
  EXPECT_FALSE(robot.hear(kPi, 1.0)) << "no way of its own there";
  robot.hear(radians(130.0), 0.8);
  EXPECT_TRUE(robot.hear(radians(130.0), 0.8)) << "round the corner";
  robot.turn(0.5 * kPi);
  robot.hear(0.0, 1.0);
  EXPECT_TRUE(robot.hear(0.0, 1.0)) << "on its way back";
}

TEST(FollowerWatch, TakesTheFrameOfADoorForNobodyAndHearsWhoStandsBeforeIt) {
  Robot robot(wall_with_door());
  robot.drive(6.5);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(robot.hear(radians(170.0), 1.3)) << "the wall is 1.3 to 1.5 m behind it";
  }
  robot.hear(radians(170.0), 0.7);
  EXPECT_TRUE(robot.hear(radians(170.0), 0.7));
  Robot without_map;
  without_map.drive(6.5);
  without_map.hear(radians(170.0), 1.3);
  EXPECT_TRUE(without_map.hear(radians(170.0), 1.3)) << "then the frame cannot be told from somebody";
}

TEST(FollowerWatch, JudgesNothingWithoutAPose) {
  Robot robot;
  robot.drive(1.0);
  EXPECT_FALSE(robot.watch.update({}, 0.2, 5.0, std::nullopt));
  EXPECT_NEAR(robot.watch.alone(), 1.0, 1e-9);
}

}  // namespace
}  // namespace luminav
