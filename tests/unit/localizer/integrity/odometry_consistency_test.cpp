#include "services/localizer/integrity/odometry_consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace luminav {
namespace {

constexpr double kPeriod = 1.0 / 15.0;  // [s] between images
constexpr double kWheelBase = 0.33;     // [m]
constexpr double kNoise = 0.01;         // [m] 1-sigma of a sighting

struct WheelSpeeds {
  double left = 0.0;   // [m/s]
  double right = 0.0;  // [m/s]
};

Pose2 step_of(const WheelSpeeds& speeds, double time) {
  const double distance = 0.5 * (speeds.left + speeds.right) * time;
  const double turn = (speeds.right - speeds.left) / kWheelBase * time;
  return {distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), wrap_angle(turn)};
}

/// A robot under one fixture whose wheels say one thing and which moves as it is told.
class WatchedRobot {
 public:
  /// The wheels turn, and the robot moves by `moved` in each second [robot frame]. Returns whether that was told.
  bool move(const WheelSpeeds& wheels, const Pose2& moved, double time) {
    return go(wheels, {moved.x * kPeriod, moved.y * kPeriod, moved.theta * kPeriod}, time);
  }
  /// The wheels turn, and slip until they move the robot as `ground` says.
  bool drive(const WheelSpeeds& wheels, const WheelSpeeds& ground, double time) {
    return go(wheels, step_of(ground, kPeriod), time);
  }
  /// A thing that moves by itself, as nothing on a ceiling does.
  void see_wandering_thing() { sees_wanderer_ = true; }
  /// The centre of the fixture, cut by the image's border, is taken to be elsewhere from now on.
  void find_fixture_elsewhere(double beside) { beside_ = beside; }
  OdometryConsistency& watch() { return watch_; }

 private:
  bool go(const WheelSpeeds& wheels, const Pose2& step, double time) {
    bool told = false;
    for (double passed = kPeriod; passed < time; passed += kPeriod) {
      odom_ = odom_ * step_of(wheels, kPeriod);
      truth_ = truth_ * step;
      utime_ += static_cast<std::int64_t>(1e6 * kPeriod);
      told = look() || told;
    }
    return told;
  }
  bool look() {
    SightingFrame frame;
    frame.utime = utime_;
    const auto see = [&](const Pose2& robot_from_thing) {
      FixtureSighting sighting;
      sighting.robot_from_fixture = robot_from_thing;
      sighting.robot_from_fixture.x += noise_(generator_);
      sighting.robot_from_fixture.y += noise_(generator_);
      sighting.covariance = kNoise * kNoise * Eigen::Matrix3d::Identity();
      frame.sightings.push_back(sighting);
    };
    see(truth_.inverse() * Pose2{0.3, 0.2 + beside_, 0.0});
    if (sees_wanderer_) {
      wanderer_y_ += 0.7 * kPeriod;
      see({-0.6, wanderer_y_, 0.0});
    }
    tracks_.update(frame, odom_, 0.0);
    return watch_.look(frame, tracks_, odom_);
  }

  std::mt19937_64 generator_{3};
  std::normal_distribution<double> noise_{0.0, kNoise};
  ObjectTracks tracks_;
  OdometryConsistency watch_{kWheelBase};
  Pose2 truth_;
  Pose2 odom_;
  std::int64_t utime_ = 1'000'000'000;
  double beside_ = 0.0;  // [m]
  bool sees_wanderer_ = false;
  double wanderer_y_ = -0.6;  // [m, robot frame]
};

TEST(OdometryConsistency, IsCalmWhileTheRobotMovesAsItsWheelsTurn) {
  for (const WheelSpeeds wheels : {WheelSpeeds{0.0, 0.0}, {0.5, 0.5}, {0.2, 0.4}, {-0.3, 0.3}, {-0.4, -0.4}}) {
    WatchedRobot robot;
    EXPECT_FALSE(robot.drive(wheels, wheels, 3.0)) << wheels.left << " " << wheels.right;
  }
}

TEST(OdometryConsistency, TellsWithinASecondThatAStandingRobotIsMoved) {
  for (const Pose2 moved : {Pose2{0.4, 0.0, 0.0}, {0.0, -0.5, 0.0}, {1.0, 1.0, 0.5}, {0.0, 0.0, 1.5}}) {
    WatchedRobot robot;
    ASSERT_FALSE(robot.move({}, {}, 1.0));
    EXPECT_TRUE(robot.move({}, moved, 1.0)) << moved.x << " " << moved.y << " " << moved.theta;
  }
}

TEST(OdometryConsistency, TellsThatARobotIsMovedAsideWhileItsWheelsTurn) {
  WatchedRobot robot;
  EXPECT_TRUE(robot.move({0.4, 0.4}, {0.0, 0.6, 0.0}, 1.0));
}

TEST(OdometryConsistency, TakesSlippingWheelsForWhatTheyAre) {
  for (const WheelSpeeds ground : {WheelSpeeds{0.0, 0.0}, {0.25, 0.25}, {0.5, 0.0}, {0.0, 0.5}}) {
    WatchedRobot robot;
    EXPECT_FALSE(robot.drive({0.5, 0.5}, ground, 3.0)) << ground.left << " " << ground.right;
  }
}

TEST(OdometryConsistency, ForgivesABump) {
  WatchedRobot robot;
  ASSERT_FALSE(robot.move({}, {}, 1.0));
  EXPECT_FALSE(robot.move({}, {0.3, 0.0, 0.3}, 0.2));
  EXPECT_FALSE(robot.move({}, {}, 1.0));
}

TEST(OdometryConsistency, IsCalmAgainOnceTheRobotRests) {
  WatchedRobot robot;
  ASSERT_TRUE(robot.move({}, {0.6, 0.0, 0.0}, 1.0));
  ASSERT_TRUE(robot.move({}, {}, 1.0));  // it looks back a little
  EXPECT_FALSE(robot.move({}, {}, 1.0));
}

TEST(OdometryConsistency, DoesNotBelieveOneThingAgainstAFixtureSeenAsLong) {
  WatchedRobot robot;
  robot.see_wandering_thing();
  EXPECT_FALSE(robot.move({}, {}, 1.5));
}

TEST(OdometryConsistency, TakesAFixtureFoundElsewhereAllAtOnceForNoMotion) {
  WatchedRobot robot;
  ASSERT_FALSE(robot.drive({0.5, 0.5}, {0.5, 0.5}, 1.0));
  robot.find_fixture_elsewhere(0.4);
  EXPECT_FALSE(robot.drive({0.5, 0.5}, {0.5, 0.5}, 1.0));
}

TEST(OdometryConsistency, ForgetsWhatWasBeforeAGap) {
  WatchedRobot robot;
  ASSERT_FALSE(robot.move({}, {}, 1.0));
  robot.watch().clear();
  EXPECT_FALSE(robot.move({}, {1.2, 0.0, 0.0}, 5.5 * kPeriod));  // without the gap two images more tell it
}

}  // namespace
}  // namespace luminav
