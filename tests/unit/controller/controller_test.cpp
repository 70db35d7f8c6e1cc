#include "services/controller/controller.hpp"

#include <gtest/gtest.h>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

/// Speed [m/s] that a person gets who asks for full speed for two seconds with a thing at a place.
double speed_with(const ObstaclePoint& obstacle) {
  Controller controller(ControllerConfig::for_robot(testing::test_robot()));
  ControlInput input;
  input.task = ControlTask::kTeleop;
  input.teleoperation = {0.5, 0.0};
  input.echoes = {obstacle};
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  double speed = 0.0;
  for (int i = 1; i <= 40; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    speed = controller.step(input).twist.linear;
  }
  return speed;
}

ObstaclePoint thing_at(double x, double y, bool has_stood) {
  ObstaclePoint thing;
  thing.position = {x, y};
  thing.age = 0.1;
  thing.has_stood = has_stood;
  return thing;
}

TEST(Controller, SlowsDownForWhatAppearsAheadAndNotForWhatStood) {
  // 0.75 m before the nose: the stop logic alone lets it go on at full speed
  EXPECT_NEAR(speed_with(thing_at(0.96, 0.0, true)), 0.5, 1e-6);
  EXPECT_LT(speed_with(thing_at(0.96, 0.0, false)), 0.40);
  EXPECT_GT(speed_with(thing_at(0.96, 0.0, false)), 0.20);
}

TEST(Controller, DrivesOnPastWhatAppearsBehindOrOnAMap) {
  EXPECT_NEAR(speed_with(thing_at(-1.0, 0.0, false)), 0.5, 1e-6);
  ObstaclePoint wall = thing_at(0.96, 0.0, false);
  wall.is_known = true;
  EXPECT_NEAR(speed_with(wall), 0.5, 1e-6);
}

TEST(Controller, GoesOnByAndByWhereSomethingNewStands) {
  // slow enough to stop in time, but never wedged by it
  EXPECT_NEAR(speed_with(thing_at(0.63, 0.45, false)), 0.2, 0.05);
}

TEST(Controller, DoesNotLeaveItsPlaceWhenItIsOnlyToTurnThere) {
  Controller controller(ControllerConfig::for_robot(testing::test_robot()));
  controller.set_path({.points = {{0.0, 0.0}}, .has_theta = true, .theta = 0.5 * kPi});
  ControlInput input;
  input.task = ControlTask::kFollow;
  input.world_from_robot = Pose2{};
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  for (const double y : {-0.28, 0.28}) {  // beside the corners, which swing out
    input.echoes.push_back(thing_at(-0.28, y, true));
    input.echoes.push_back(thing_at(0.18, y, true));
  }
  for (int i = 1; i <= 400; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    const ControlOutput output = controller.step(input);
    ASSERT_NE(output.state, ControlState::kEscaping) << output.reason;
    ASSERT_EQ(output.twist.linear, 0.0);
  }
}

/// A robot that has driven along its path for a while, then touches something with its front.
struct Touching {
  Touching() {
    controller.set_path({.points = {{0.0, 0.0}, {5.0, 0.0}}});
    input.now = 1'000'000;
    input.task = ControlTask::kFollow;
    input.world_from_robot = Pose2{};
    input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
    run(1.0);
  }
  ControlOutput run(double seconds) {
    ControlOutput output;
    for (int i = 0; i < static_cast<int>(std::lround(20.0 * seconds)); ++i) {
      input.now += 50'000;
      output = controller.step(input);
    }
    return output;
  }
  Controller controller{ControllerConfig::for_robot(testing::test_robot())};
  ControlInput input;
};

TEST(Controller, BacksOffAtOnceFromWhatABumperFeels) {
  Touching robot;
  EXPECT_GT(robot.run(0.05).twist.linear, 0.1);
  robot.input.ages.front_bumper = true;
  const ControlOutput output = robot.run(0.5);
  EXPECT_EQ(output.state, ControlState::kEscaping);
  EXPECT_LT(output.twist.linear, 0.0);
  EXPECT_EQ(output.twist.angular, 0.0) << "the way it came";
  robot.input.ages.front_bumper = false;
  EXPECT_GT(robot.run(2.0).twist.linear, 0.1) << "and goes on";
}

TEST(Controller, DoesNotBackOffWhereItSeesNothingBehindOrThereIsSomething) {
  for (const bool is_blind : {true, false}) {
    Touching robot;
    robot.input.ages.front_bumper = true;
    robot.input.ages.rear_sonar = is_blind ? 5.0 : 0.2;
    if (!is_blind) {
      robot.input.echoes.push_back(thing_at(-0.35, 0.0, true));
    }
    EXPECT_EQ(robot.run(0.5).twist.linear, 0.0);
  }
}

ControllerConfig searching(SearchManner manner) {
  ControllerConfig config = ControllerConfig::for_robot(testing::test_robot());
  config.building.search = manner;
  return config;
}

/// A robot that searches before a wall, so that it wants to turn, with a thing at a place.
ControlInput search_with(const ObstaclePoint& thing) {
  ControlInput input;
  input.task = ControlTask::kWander;
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  for (double y = -0.6; y < 0.65; y += 0.1) {
    input.echoes.push_back(thing_at(0.60, y, true));
  }
  input.echoes.push_back(thing);
  input.remembered = input.echoes;
  return input;
}

TEST(Controller, SearchesFreeFloorAlmostAsFastAsItDrivesThere) {
  Controller controller(searching(SearchManner::kWander));
  ControlInput input = search_with(thing_at(9.0, 0.0, true));
  input.echoes.clear();
  input.remembered.clear();
  double speed = 0.0;
  for (int i = 1; i <= 40; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    speed = controller.step(input).twist.linear;
  }
  EXPECT_GE(speed, 0.8 * testing::test_robot().limits.linear - 1e-6);
}

TEST(Controller, MakesRoomWhereACornerForbidsTheTurnToItsWayOfSearch) {
  Controller controller(searching(SearchManner::kWander));
  ControlInput input = search_with(thing_at(-0.27, 0.285, true));
  input.echoes.push_back(thing_at(-0.27, -0.285, true));  // beside the rear corners, which swing out
  input.remembered = input.echoes;
  std::string reason;
  for (int i = 1; i <= 100 && reason.empty(); ++i) {
    input.now = 1'000'000 + 50'000 * i;
    const ControlOutput output = controller.step(input);
    reason = output.state == ControlState::kEscaping ? output.reason : "";
  }
  EXPECT_EQ(reason, "making room to turn");
}

TEST(Controller, TurnsAtFullSpeedBesideWhatStoodWhileItSearches) {
  const auto rate_beside = [](bool has_stood) {
    Controller controller(searching(SearchManner::kWander));
    ControlInput input = search_with(thing_at(0.0, 0.55, has_stood));
    double rate = 0.0;
    for (int i = 1; i <= 30; ++i) {
      input.now = 1'000'000 + 50'000 * i;
      rate = std::max(rate, std::abs(controller.step(input).twist.angular));
    }
    return rate;
  };
  EXPECT_NEAR(rate_beside(true), radians(45.0), 1e-6);
  EXPECT_LT(rate_beside(false), radians(42.0));
}

TEST(Controller, DoesNotWaitLongForPeopleWhileItMayAsWellSearchElsewhere) {
  Controller controller(searching(SearchManner::kWander));
  ControlInput input = search_with(thing_at(0.0, 0.29, false));
  input.echoes.back().approach = 0.5;
  input.echoes.push_back(thing_at(0.0, -0.29, false));
  input.echoes.back().approach = 0.5;
  input.remembered = input.echoes;
  double waited = 0.0;  // [s]
  for (int i = 1; i <= 200 && waited == 0.0; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    waited = controller.step(input).state == ControlState::kEscaping ? 0.05 * i : 0.0;
  }
  EXPECT_GT(waited, 2.9);
  EXPECT_LT(waited, 6.4) << "which is what it waits on its way to a goal";
}

TEST(Controller, ForgetsThePeopleItMetWhenTheOdometryBeginsAnew) {
  Controller controller(ControllerConfig::for_robot(testing::test_robot()));
  controller.set_path({.points = {{0.0, 0.0}, {2.0, 0.0}}});
  ControlInput input;
  input.task = ControlTask::kFollow;
  input.world_from_robot = Pose2{};
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  input.now = 3'600'000'000;
  input.echoes = {thing_at(0.8, 0.0, false)};
  input.echoes.front().approach = 0.5;
  controller.step(input);
  controller.forget_odometry();
  input.echoes.clear();
  for (const double y : {-0.4, -0.2, 0.0, 0.2, 0.4}) {  // things all round, which nobody ever moved
    for (const double x : {-0.36, 0.26}) {
      input.echoes.push_back(thing_at(x, y, true));
    }
    input.echoes.push_back(thing_at(0.5 * y, y < 0.0 ? -0.27 : 0.27, true));
  }
  for (int i = 1; i <= 200; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    ASSERT_NE(controller.step(input).state, ControlState::kYielding) << 0.05 * i << " s";
  }
}

TEST(Controller, GetsNowhereWhenItsWheelsSpinOnTheSpot) {
  Controller controller(ControllerConfig::for_robot(testing::test_robot()));
  controller.set_path({.points = {{0.0, 0.0}, {4.0, 0.0}}});
  ControlInput input;
  input.task = ControlTask::kFollow;
  input.world_from_robot = Pose2{};  // something that no sonar hears holds it, and the ceiling shows it
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  bool has_escaped = false;
  for (int i = 1; i <= 400 && !has_escaped; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    const ControlOutput output = controller.step(input);
    has_escaped = output.state == ControlState::kEscaping;
    input.odom_from_robot = input.odom_from_robot * Pose2{0.05 * output.twist.linear, 0.0, 0.0};
  }
  EXPECT_TRUE(has_escaped);
}

/// Drives a search on free floor for a minute and a half; returns the turn [rad] and the way [m] driven.
struct SearchTrack {
  double turned = 0.0;
  double way = 0.0;
  ControlOutput last;
};
SearchTrack search_for_long(Controller& controller, Pose2& odom_from_robot, std::int64_t& now) {
  SearchTrack track;
  ControlInput input = search_with(thing_at(9.0, 0.0, true));
  input.echoes.clear();
  input.remembered.clear();
  for (int i = 1; i <= 1800; ++i) {
    input.now = now += 50'000;
    input.odom_from_robot = odom_from_robot;
    track.last = controller.step(input);
    odom_from_robot = odom_from_robot * drive_arc(track.last.twist, 0.05);
    track.turned += 0.05 * std::abs(track.last.twist.angular);
    track.way += 0.05 * std::abs(track.last.twist.linear);
  }
  return track;
}

TEST(Controller, LooksRoundOnceWithoutLeavingItsPlaceUnlessTheBuildingAllowsToWander) {
  Controller controller(ControllerConfig::for_robot(testing::test_robot()));
  Pose2 robot;
  std::int64_t now = 1'000'000;
  const SearchTrack track = search_for_long(controller, robot, now);
  EXPECT_EQ(track.way, 0.0);
  EXPECT_NEAR(degrees(track.turned), 400.0, 10.0);
  EXPECT_NE(track.last.reason.find("tell it, or push it on"), std::string::npos);
  robot = robot * Pose2{1.0, 0.0, 0.0};  // somebody pushed it on
  EXPECT_NEAR(degrees(search_for_long(controller, robot, now).turned), 400.0, 10.0);
}

TEST(Controller, StandsWhereTheBuildingAllowsNoSearch) {
  Controller controller(searching(SearchManner::kStand));
  Pose2 robot;
  std::int64_t now = 1'000'000;
  const SearchTrack track = search_for_long(controller, robot, now);
  EXPECT_EQ(track.way, 0.0);
  EXPECT_EQ(track.turned, 0.0);
  EXPECT_NE(track.last.reason.find("stands until it knows"), std::string::npos);
}

TEST(Controller, DoesNotLeaveItsPlaceToFreeATurnWhereItMayOnlyLookRound) {
  Controller controller(searching(SearchManner::kTurn));
  ControlInput input = search_with(thing_at(-0.27, 0.285, true));
  input.echoes.push_back(thing_at(-0.27, -0.285, true));  // beside the rear corners, which swing out
  for (int i = 1; i <= 400; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    const ControlOutput output = controller.step(input);
    ASSERT_NE(output.state, ControlState::kEscaping);
    ASSERT_EQ(output.twist.linear, 0.0);
  }
}

}  // namespace
}  // namespace luminav
