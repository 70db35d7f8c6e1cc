#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/planner/goals/goal_store.hpp"
#include "tests/node/planner/planner_world.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/time_zone.hpp"

namespace luminav {
namespace {

using Status = navigation_status_t;
using ::testing::HasSubstr;

Eigen::Vector2d end_of(const path_t& path) {
  return {static_cast<double>(path.x.back()), static_cast<double>(path.y.back())};
}

TEST(PlannerNode, BringsTheRobotThroughTheDoorAndSaysArrived) {
  PlannerWorld world;
  world.run(1.0);
  world.go(5, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED));
  EXPECT_EQ(world.status.goal_id, 5);
  EXPECT_LT(std::hypot(world.robot.x - 9.0, world.robot.y - 4.0), 0.15);
  EXPECT_EQ(world.path.count, 0);
  EXPECT_EQ(world.states.front(), Status::STATE_IDLE);
  EXPECT_EQ(world.states.back(), Status::STATE_ARRIVED);
}

TEST(PlannerNode, PutsPathPointsAtMostAQuarterMetreApartFromTheRobotToTheGoal) {
  PlannerWorld world;
  world.go(5, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  ASSERT_GT(world.path.count, 10);
  EXPECT_NEAR(static_cast<double>(world.path.x[0]), world.robot.x, 0.06);
  EXPECT_NEAR(end_of(world.path).x(), 9.0, 1e-5);
  EXPECT_NEAR(end_of(world.path).y(), 4.0, 1e-5);
  for (std::size_t i = 1; i < static_cast<std::size_t>(world.path.count); ++i) {
    EXPECT_LE(std::hypot(world.path.x[i] - world.path.x[i - 1], world.path.y[i] - world.path.y[i - 1]), 0.25);
  }
}

TEST(PlannerNode, SearchesForItsPlaceBeforeItPlans) {
  PlannerWorld world;
  world.tracking = false;
  world.go(1, 9.0, 4.0);
  world.run(20.0);
  EXPECT_EQ(world.status.state, Status::STATE_LOCALIZING);
  EXPECT_EQ(world.status.cause, "no fixture seen yet");
  EXPECT_EQ(world.path.count, 0);
  world.tracking = true;
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED));
}

TEST(PlannerNode, KeepsTheGoalWhileItIsLostOnTheWay) {
  PlannerWorld world;
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.run(3.0);
  world.tracking = false;
  world.run(0.5);
  EXPECT_EQ(world.status.state, Status::STATE_FOLLOWING) << "a moment without a pose is no reason to search";
  world.run(2.0);
  EXPECT_EQ(world.status.state, Status::STATE_LOCALIZING);
  EXPECT_EQ(world.path.count, 0);
  world.robot = {2.0, 1.0, 1.0};
  world.tracking = true;
  EXPECT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED));
}

TEST(PlannerNode, GivesUpSearchingAfterALongTimeAndSaysSo) {
  PlannerConfig config;
  config.goals.lost_timeout = 30.0;
  PlannerWorld world(config);
  world.tracking = false;
  world.go(1, 9.0, 4.0);
  world.run(29.0);
  EXPECT_EQ(world.status.state, Status::STATE_LOCALIZING);
  world.run(3.0);
  EXPECT_EQ(world.status.state, Status::STATE_LOST);
  EXPECT_THAT(world.status.cause, HasSubstr("30 s"));
}

TEST(PlannerNode, SearchesAsLongForANewGoalAsForTheOneBefore) {
  PlannerWorld world;
  world.tracking = false;
  world.go(1, 9.0, 4.0);
  world.run(590.0);
  world.go(2, 4.0, 1.5);
  world.run(20.0);
  EXPECT_EQ(world.status.goal_id, 2);
  EXPECT_EQ(world.status.state, Status::STATE_LOCALIZING) << world.status.cause;
  world.run(585.0);
  EXPECT_EQ(world.status.state, Status::STATE_LOST);
}

TEST(PlannerNode, GetsStuckAfterTheRobotsClockWentBackToo) {
  PlannerWorld world;
  world.utime += 3'600'000'000;
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = true;
  world.run(30.0);
  ASSERT_NE(world.status.state, Status::STATE_STUCK);
  world.base_speaks = false;  // so that it never takes its pose for lost
  world.utime -= 3'600'000'000;
  EXPECT_TRUE(world.run_until_state(200.0, Status::STATE_STUCK));
}

TEST(PlannerNode, GivesUpWhenThePoseGetsLostAgainAndAgainAtOnePlace) {
  PlannerWorld world;
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = true;
  for (int i = 0; i < 15 && world.status.state != Status::STATE_LOST; ++i) {
    world.tracking = false;
    world.run(2.0);
    world.tracking = true;
    world.run(1.0);
  }
  EXPECT_EQ(world.status.state, Status::STATE_LOST);
  EXPECT_THAT(world.status.cause, HasSubstr("lost its place 10 times"));
}

TEST(PlannerNode, CountsNoAttemptsFromBeforeItGotLost) {
  PlannerWorld world;
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = true;
  world.run(55.0);
  ASSERT_NE(world.status.state, Status::STATE_STUCK);
  world.tracking = false;
  world.run(3.0);
  ASSERT_EQ(world.status.state, Status::STATE_LOCALIZING);
  world.robot = {2.0, 1.0, 1.0};  // it searched elsewhere
  world.tracking = true;
  world.run(30.0);
  EXPECT_NE(world.status.state, Status::STATE_STUCK) << world.status.cause;
  EXPECT_TRUE(world.run_until_state(120.0, Status::STATE_STUCK)) << "it still ends";
}

TEST(PlannerNode, HasArrivedWhenItFindsItselfAtTheGoal) {
  PlannerWorld world;
  world.go(1, 4.0, 1.5);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.tracking = false;
  world.run(2.0);
  ASSERT_EQ(world.status.state, Status::STATE_LOCALIZING);
  world.robot = {4.05, 1.45, 0.0};
  world.tracking = true;
  world.run(0.2);
  EXPECT_EQ(world.status.state, Status::STATE_ARRIVED);
}

TEST(PlannerNode, TicksOnRobotStatusWhenNoPoseFlows) {
  PlannerWorld world;
  world.pose_flows = false;
  world.go(1, 9.0, 4.0);
  world.run(5.0);
  EXPECT_EQ(world.status.state, Status::STATE_LOCALIZING);
  EXPECT_EQ(world.status.goal_id, 1);
  EXPECT_THAT(world.status.cause, HasSubstr("no pose"));
}

TEST(PlannerNode, ActsOnARepeatedGoalOnce) {
  PlannerWorld world;
  world.go(3, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.run(1.0);
  const int sequence = world.path.sequence;
  for (int i = 0; i < 5; ++i) {
    world.go(3, 9.0, 4.0);
    world.run(0.2);
  }
  EXPECT_EQ(world.path.sequence, sequence);
}

TEST(PlannerNode, ReplacesAGoalByAFreshOne) {
  PlannerWorld world;
  world.go(3, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.run(2.0);
  world.go(4, 2.0, 1.5);
  ASSERT_TRUE(world.run_until_state(30.0, Status::STATE_ARRIVED));
  EXPECT_EQ(world.status.goal_id, 4);
  EXPECT_LT(std::hypot(world.robot.x - 2.0, world.robot.y - 1.5), 0.15);
}

TEST(PlannerNode, CancelsPausesAndResumes) {
  PlannerWorld world;
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.run(2.0);
  world.act(2, goal_t::ACTION_PAUSE);
  EXPECT_EQ(world.status.state, Status::STATE_PAUSED);
  EXPECT_EQ(world.status.goal_id, 2);
  const Pose2 here = world.robot;
  world.run(5.0);
  EXPECT_NEAR(distance(world.robot, here), 0.0, 1e-9);
  world.act(3, goal_t::ACTION_RESUME);
  world.run(2.0);
  EXPECT_EQ(world.status.state, Status::STATE_FOLLOWING);
  EXPECT_GT(distance(world.robot, here), 0.3);
  EXPECT_EQ(world.path.goal_id, world.status.goal_id) << "the controller would wait for the path of that goal";
  world.act(4, goal_t::ACTION_CANCEL);
  EXPECT_EQ(world.status.state, Status::STATE_CANCELLED);
  EXPECT_EQ(world.status.goal_id, 4);
  EXPECT_EQ(world.path.count, 0);
}

TEST(PlannerNode, DrivesOnWhenARobotIsResumedThatWasNotPaused) {
  PlannerWorld world;
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.run(1.0);
  world.act(2, goal_t::ACTION_RESUME);
  world.run(0.5);
  EXPECT_EQ(world.status.state, Status::STATE_FOLLOWING);
  EXPECT_EQ(world.status.goal_id, 2);
  EXPECT_EQ(world.path.goal_id, 2) << "the controller would wait for the path of that goal";
  EXPECT_GT(world.path.count, 0);
}

TEST(PlannerNode, RefusesWhatCannotBeReachedAndSaysWhyWithNumbers) {
  PlannerWorld world;
  world.wall(61, 28, 63, 37);  // no door any more
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_NO_PATH));
  EXPECT_THAT(world.status.cause, HasSubstr("nearest reachable point"));
  world.go(2, 30.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_NO_PATH));
  EXPECT_EQ(world.status.goal_id, 2);
  EXPECT_THAT(world.status.cause, HasSubstr("outside the map"));
  world.go(3, 6.2, 1.0);
  world.run(3.0);
  EXPECT_EQ(world.status.state, Status::STATE_NO_PATH);
  EXPECT_EQ(world.status.goal_id, 3);
  EXPECT_THAT(world.status.cause, HasSubstr("obstacle"));
}

TEST(PlannerNode, RefusesGoalsThatAreNoGoals) {
  PlannerWorld world;
  world.run(1.0);
  goal_t broken = world.goal(1, {{1e6, 1.0}});
  world.send(broken);
  EXPECT_EQ(world.status.state, Status::STATE_NO_PATH);
  EXPECT_EQ(world.status.goal_id, 1);
  world.send(world.goal(2, {}));
  EXPECT_EQ(world.status.state, Status::STATE_NO_PATH);
  EXPECT_EQ(world.status.goal_id, 2);
  goal_t elsewhere = world.goal(3, {{1.0, 1.0}});
  elsewhere.floor = "second";
  world.send(elsewhere);
  EXPECT_EQ(world.status.state, Status::STATE_NO_PATH);
  EXPECT_EQ(world.status.goal_id, 3);
  EXPECT_THAT(world.status.cause, HasSubstr("floor second"));
  EXPECT_EQ(world.node.health().dropped_inputs, 3);
}

TEST(PlannerNode, RefusesPlacesOfAnotherBuilding) {
  PlannerConfig config;
  config.building = "office";
  config.places = {{.name = "lift", .pose = {9.0, 4.0, 0.0}}};
  PlannerWorld world(config);
  world.run(1.0);
  std::int64_t id = 0;
  for (const auto& [name, x] : {std::pair("workbench", 9.0), std::pair("lift", 8.0)}) {
    goal_t goal = world.goal(++id, {{x, 4.0}});
    goal.poses[0].place = name;
    world.send(goal);
    EXPECT_EQ(world.status.state, Status::STATE_NO_PATH);
    EXPECT_EQ(world.status.goal_id, id);
    EXPECT_THAT(world.status.cause, HasSubstr(std::string("office has no place ") + name));
    EXPECT_EQ(world.path.count, 0);
  }
  goal_t goal = world.goal(++id, {{9.0, 4.0}});
  goal.poses[0].place = "lift";
  world.send(goal);
  EXPECT_NE(world.status.state, Status::STATE_NO_PATH);
}

TEST(PlannerNode, RefusesAGoalInAKeepOutZoneByItsName) {
  PlannerConfig config;
  config.route.space.zones = {{"stairs", ZoneKind::kKeepOut, {{8.0, 3.0}, {10.0, 3.0}, {10.0, 5.0}, {8.0, 5.0}}, 0.2}};
  PlannerWorld world(config);
  world.run(1.0);
  world.send(world.goal(1, {{9.0, 4.0}}));
  EXPECT_EQ(world.status.state, Status::STATE_NO_PATH);
  EXPECT_THAT(world.status.cause, HasSubstr("stairs"));
  EXPECT_EQ(world.path.count, 0);
}

TEST(PlannerNode, NamesTheZoneThatLeavesNoWay) {
  for (const ZoneKind kind : {ZoneKind::kKeepOut, ZoneKind::kOneWay}) {
    PlannerConfig config;
    const Zone before_the_door{"stairs", kind, {{5.6, 2.0}, {6.8, 2.0}, {6.8, 4.4}, {5.6, 4.4}}, 0.2, kPi};
    const Zone elsewhere{"office", ZoneKind::kKeepOut, {{10.0, 0.5}, {11.0, 0.5}, {11.0, 1.5}, {10.0, 1.5}}};
    config.route.space.zones = {elsewhere, before_the_door};
    PlannerWorld world(config);
    world.run(1.0);
    world.send(world.goal(1, {{9.0, 4.0}}));
    ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_NO_PATH)) << world.status.cause;
    EXPECT_THAT(world.status.cause, HasSubstr("zone stairs"));
    EXPECT_THAT(world.status.cause, testing::Not(HasSubstr("office")));
  }
}

TEST(PlannerNode, DrivesOutOfAKeepOutZoneAndSaysSo) {
  PlannerConfig config;
  config.route.space.zones = {{"stairs", ZoneKind::kKeepOut, {{0.5, 1.0}, {2.8, 1.0}, {2.8, 5.0}, {0.5, 5.0}}}};
  PlannerWorld world(config);
  world.run(1.0);
  world.send(world.goal(1, {{4.5, 1.0}}));
  world.run(0.5);
  EXPECT_THAT(world.status.cause, HasSubstr("inside the keep-out zone stairs"));
  ASSERT_TRUE(world.run_until(5.0, [&] { return world.robot.x > 3.2; }));
  EXPECT_LT(std::abs(world.robot.y - 3.0), 0.8) << "straight to the nearest edge";
  EXPECT_EQ(world.status.cause, "");
  EXPECT_TRUE(world.run_until_state(20.0, Status::STATE_ARRIVED));
}

TEST(PlannerConfig, ReadsTheSideToKeepAndRefusesAnyOther) {
  const TemporaryFolder folder;
  const std::string launch = std::string(LUMINAV_SOURCE_DIR) + "/launch/";
  const auto read = [&](const std::string& planner) {
    const auto robot =
        folder.write("robot.toml", read_whole_file(launch + "robots/p3dx.toml") + "\n[planner]\n" + planner);
    return read_planner_config(robot, launch + "buildings/laboratory/building.toml").route.shaping.keep_side;
  };
  EXPECT_EQ(read(""), KeepSide::kNone);
  EXPECT_EQ(read("keep_side = \"right\"\n"), KeepSide::kRight);
  EXPECT_EQ(read("keep_side = \"left\"\n"), KeepSide::kLeft);
  EXPECT_THROW(read("keep_side = \"middle\"\n"), ConfigurationError);
}

// The first ten minutes of PlannerWorld's clock: it begins at 00:16:40 of Thursday, 1 January 1970.
constexpr Hours kFromNextMinute{17 * 60, 12 * 3600};
constexpr Hours kUntilNextMinute{12 * 3600, 17 * 60};
const Polygon kBeforeTheDoor = {{5.6, 2.0}, {6.8, 2.0}, {6.8, 4.4}, {5.6, 4.4}};

PlannerConfig with_hours(const Polygon& polygon, const Hours& hours) {
  PlannerConfig config;
  config.route.space.zones = {{.name = "yard", .polygon = polygon, .hours = hours}};
  return config;
}

TEST(PlannerNode, SaysUntilWhenAZoneRefusesAGoal) {
  PlannerWorld inside(with_hours({{8.0, 3.0}, {10.0, 3.0}, {10.0, 5.0}}, kUntilNextMinute));
  inside.run(1.0);
  inside.go(1, 9.5, 3.5);
  EXPECT_EQ(inside.status.cause, "(9.5, 3.5) lies in yard, which is a keep-out zone until 00:17");
  PlannerWorld behind(with_hours(kBeforeTheDoor, kUntilNextMinute));
  behind.run(1.0);
  behind.go(1, 9.0, 4.0);
  ASSERT_TRUE(behind.run_until_state(5.0, Status::STATE_NO_PATH)) << behind.status.cause;
  EXPECT_THAT(behind.status.cause, HasSubstr("in the way: keep-out zone yard until 00:17"));
}

TEST(PlannerNode, DrivesThroughAZoneThatIsOver) {
  PlannerWorld world(with_hours(kBeforeTheDoor, kUntilNextMinute));
  world.run(25.0);
  world.go(1, 9.0, 4.0);
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(PlannerNode, GivesUpWhatAZoneShutsOffThatBeginsWhileItDrives) {
  PlannerWorld world(with_hours(kBeforeTheDoor, kFromNextMinute));
  world.run(19.0);
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(0.5, Status::STATE_FOLLOWING)) << world.status.cause;
  ASSERT_TRUE(world.run_until_state(1.0, Status::STATE_NO_PATH)) << world.status.cause;
  EXPECT_THAT(world.status.cause, HasSubstr("keep-out zone yard until 12:00"));
  EXPECT_EQ(world.path.count, 0);
}

TEST(PlannerNode, GoesOnByANewPathWhenAZoneBeginsElsewhere) {
  PlannerWorld world(with_hours({{9.0, 0.5}, {11.0, 0.5}, {11.0, 1.5}}, kFromNextMinute));
  world.run(19.0);
  world.go(1, 9.0, 4.0);
  const std::int32_t sequence = world.path.sequence;
  ASSERT_TRUE(world.run_until(2.0, [&] { return world.path.sequence > sequence; }));
  EXPECT_GT(world.path.count, 1) << "it does not stand meanwhile";
  EXPECT_EQ(world.status.state, Status::STATE_FOLLOWING);
}

TEST(PlannerNode, DrivesOutOfAZoneThatBeginsRoundIt) {
  PlannerWorld world(with_hours({{0.5, 1.0}, {2.8, 1.0}, {2.8, 5.0}, {0.5, 5.0}}, kFromNextMinute));
  world.run(19.8);
  world.go(1, 4.5, 1.0);
  ASSERT_TRUE(world.run_until(2.0, [&] { return !world.status.cause.empty(); }));
  EXPECT_EQ(world.status.cause, "inside the keep-out zone yard until 12:00: driving out by the shortest way");
  EXPECT_TRUE(world.run_until_state(20.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(PlannerNode, KeepsTheHoursOfItsOwnClockWhereverTheMachineStands) {
  const TimeZone berlin("CET-1");
  PlannerWorld world(with_hours({{8.0, 3.0}, {10.0, 3.0}, {10.0, 5.0}}, kUntilNextMinute));
  world.run(1.0);
  world.go(1, 9.5, 3.5);
  EXPECT_THAT(world.status.cause, HasSubstr("until 00:17"));
  PlannerConfig of_a_process = with_hours({{8.0, 3.0}, {10.0, 3.0}, {10.0, 5.0}}, kUntilNextMinute);
  of_a_process.local_clock = local_time;
  PlannerWorld there(of_a_process);
  there.run(1.0);
  there.go(1, 9.5, 3.5);
  EXPECT_NE(there.status.state, Status::STATE_NO_PATH) << "there it is a quarter past one: " << there.status.cause;
}

TEST(PlannerNode, ObeysZonesThatAreDrawnWhileItDrives) {
  PlannerWorld world;
  world.go(1, 9.0, 4.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  Building building;
  building.zones = {{"wet floor", ZoneKind::kQuiet, {{1.0, 1.0}, {2.0, 1.0}, {2.0, 2.0}}}};
  world.node.set_building(building);
  while (world.lcm.handleTimeout(0) > 0) {
  }
  EXPECT_EQ(world.path.count, 0) << "it stands until it has a path by the new zones";
  ASSERT_TRUE(world.run_until_state(1.0, Status::STATE_FOLLOWING));
  const std::int32_t sequence = world.path.sequence;
  world.node.set_building(building);
  world.run(0.5);
  EXPECT_EQ(world.path.sequence, sequence) << "the same ones change nothing";
  building.zones.push_back({"stairs", ZoneKind::kKeepOut, {{5.6, 2.0}, {6.8, 2.0}, {6.8, 4.4}, {5.6, 4.4}}});
  world.node.set_building(building);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_NO_PATH)) << world.status.cause;
  EXPECT_THAT(world.status.cause, HasSubstr("keep-out zone stairs"));
  building.zones.clear();
  world.node.set_building(building);
  world.go(2, 9.0, 4.0);
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED));
}

TEST(PlannerNode, IgnoresAGoalFromBeforeTheLastOne) {
  PlannerWorld world;
  world.run(1.0);
  world.go(100, 4.0, 1.5);
  world.go(50, 2.0, 3.0);  // of a recording
  world.run(0.5);
  EXPECT_EQ(world.status.goal_id, 100);
  EXPECT_EQ(world.node.health().dropped_inputs, 1);
}

TEST(PlannerNode, DrivesToTheNearestPointWithinTheToleranceOfABlockedGoal) {
  PlannerWorld world;
  goal_t goal = world.goal(1, {{5.9, 1.5}});  // 0.2 m from the wall: the robot's middle cannot be there
  goal.tolerance = 0.4;
  world.send(goal);
  ASSERT_TRUE(world.run_until_state(30.0, Status::STATE_ARRIVED));
  EXPECT_LT(std::hypot(world.robot.x - 5.9, world.robot.y - 1.5), 0.4);
}

TEST(PlannerNode, GoesRoundABoxThatAppearsOnTheWay) {
  PlannerWorld world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(3.5, 2.9, 4.0, 3.5);
  ASSERT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED));
  EXPECT_GE(world.status.replans, 1);
  EXPECT_LE(world.status.replans, 3);
}

TEST(PlannerNode, CallsItselfStuckInBoundedTimeWhenNothingMoves) {
  PlannerWorld world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = true;
  ASSERT_TRUE(world.run_until(
      150.0, [&] { return world.status.state == Status::STATE_STUCK || world.status.state == Status::STATE_BLOCKED; }));
  EXPECT_THAT(world.status.cause, HasSubstr("no progress"));
}

TEST(PlannerNode, GoesRoundWhatBlockedItsWheelsThoughNoSonarHeardIt) {
  PlannerWorld world;
  world.go(1, 4.5, 3.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  ASSERT_TRUE(world.run_until(20.0, [&] { return world.robot.x > 3.0; }));
  const Eigen::Vector2d touched = world.robot * Eigen::Vector2d(0.36, 0.0);
  world.wheels_blocked = world.stalled = true;
  world.run(1.0);
  EXPECT_GE(world.status.replans, 1);
  for (std::size_t i = 0; i < static_cast<std::size_t>(world.path.count); ++i) {
    const Eigen::Vector2d point(world.path.x[i], world.path.y[i]);
    if ((point - world.robot.position()).norm() > 0.4) {  // the way out leads past it
      EXPECT_GT((point - touched).norm(), 0.40);
    }
  }
  world.wheels_blocked = world.stalled = false;
  EXPECT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(PlannerNode, HearsOfATouchThatIsOverBeforeItsNextTick) {
  PlannerWorld world;
  world.go(1, 4.5, 3.0);
  ASSERT_TRUE(world.run_until(20.0, [&] { return world.robot.x > 3.0; }));
  const int paths = world.paths;
  robot_status_t touch{};
  touch.utime = world.utime + 20'000;
  touch.connected = touch.motors_enabled = 1;
  touch.bumpers_front = 1;
  world.lcm.publish(channels::kRobotStatus, &touch);
  world.run(1.0);
  EXPECT_GT(world.paths, paths);
  EXPECT_GE(world.status.replans, 1);
}

TEST(PlannerNode, HasMorePatienceWithPeopleThanWithThingsButNotForEver) {
  PlannerWorld world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = true;
  const auto meet_people = [&](double seconds) {  // they come and go, and the robot never gets anywhere
    for (double passed = 0.0; passed < seconds && world.status.state != Status::STATE_STUCK; passed += 10.0) {
      world.yields = true;
      world.run(5.0);
      world.yields = false;
      world.run(5.0);
    }
  };
  meet_people(150.0);
  EXPECT_NE(world.status.state, Status::STATE_STUCK) << world.status.cause;
  meet_people(300.0);
  EXPECT_EQ(world.status.state, Status::STATE_STUCK);
}

TEST(PlannerNode, SaysThatItWaitsUntilItHasSetOff) {
  PlannerWorld world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = true;
  world.states.clear();
  for (int step = 0; step < 40; ++step) {  // somebody comes and goes before the robot's nose
    world.yields = step % 4 == 0;
    world.run(0.1);
  }
  EXPECT_EQ(world.states, (std::vector<std::int8_t>{Status::STATE_FOLLOWING, Status::STATE_WAITING}));
  world.wheels_blocked = world.yields = false;
  world.run(0.3);
  EXPECT_EQ(world.status.state, Status::STATE_FOLLOWING);
  EXPECT_EQ(world.status.cause, "");

  world.wheels_blocked = world.yields = true;
  world.run(0.3);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  world.yields = false;  // nobody is there any more; something else keeps it
  world.run(1.3);
  EXPECT_EQ(world.status.state, Status::STATE_FOLLOWING);
}

TEST(PlannerNode, GoesRoundPeopleWhoDoNotLetItPassForAMinute) {
  PlannerWorld world;
  world.wall(61, 50, 63, 60, Prior::kFree);  // another door
  world.robot = {4.6, 3.2, 0.0};
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = true;
  world.yields = true;
  const auto leads_by_the_other_door = [&] {
    return *std::max_element(world.path.y.begin(), world.path.y.end()) > 5.0F;
  };
  EXPECT_FALSE(world.run_until(55.0, leads_by_the_other_door)) << "people come and go";
  ASSERT_TRUE(world.run_until(60.0, leads_by_the_other_door)) << world.status.cause;
  world.wheels_blocked = false;
  world.yields = false;
  EXPECT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(PlannerNode, GoesOnWhenPeopleHaveGoneAtLast) {
  PlannerWorld world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.wheels_blocked = world.yields = true;
  world.run(120.0);
  world.wheels_blocked = world.yields = false;
  EXPECT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(PlannerNode, NoticesASilentController) {
  PlannerWorld world;
  world.controller_runs = false;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(150.0, Status::STATE_STUCK));
  EXPECT_THAT(world.status.cause, HasSubstr("controller is silent"));
}

TEST(PlannerNode, IsPatientWhileTheMotorsAreOff) {
  PlannerWorld world;
  world.motors = false;
  world.go(1, 9.0, 3.2);
  world.run(300.0);
  EXPECT_EQ(world.status.state, Status::STATE_FOLLOWING);
  EXPECT_EQ(world.status.cause, "the motors are off");
  world.motors = true;
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED));
}

TEST(PlannerNode, DrivesARoundOfStopsAndStaysAtEach) {
  PlannerWorld world;
  goal_t goal = world.goal(1, {{4.0, 1.5}, {9.0, 4.0}});
  goal.poses[0].wait = 5.0;
  goal.poses[1].has_theta = 1;
  goal.poses[1].theta = 2.0;
  world.send(goal);
  ASSERT_TRUE(world.run_until_state(30.0, Status::STATE_WAITING));
  const Pose2 first = world.robot;
  world.run(4.0);
  EXPECT_NEAR(distance(world.robot, first), 0.0, 1e-9);
  ASSERT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED));
  EXPECT_NEAR(world.robot.theta, 2.0, 0.09);
  EXPECT_EQ(world.status.pose_index, 1);
}

TEST(PlannerNode, SkipsAFailedStopWhenToldSo) {
  PlannerWorld world;
  goal_t goal = world.goal(1, {{30.0, 1.5}, {4.0, 1.5}});
  goal.policy = goal_t::POLICY_SKIP;
  world.send(goal);
  ASSERT_TRUE(world.run_until_state(30.0, Status::STATE_ARRIVED));
  EXPECT_THAT(world.status.cause, HasSubstr("1 of 2"));
}

TEST(PlannerNode, LoopsUntilCancelled) {
  PlannerWorld world;
  goal_t goal = world.goal(1, {{4.0, 1.5}, {2.0, 1.5}});
  goal.loop = 1;
  world.send(goal);
  int rounds = 0;
  int last = 0;
  (void)world.run_until(120.0, [&] {
    rounds += world.status.pose_index == 0 && last == 1 ? 1 : 0;
    last = world.status.pose_index;
    return false;
  });
  EXPECT_GE(rounds, 5);
  world.act(2, goal_t::ACTION_CANCEL);
  EXPECT_EQ(world.status.state, Status::STATE_CANCELLED);
}

TEST(PlannerNode, AsksForTilesUntilItHasThemAll) {
  PlannerWorld world;
  world.mapper_runs = false;
  world.go(1, 9.0, 3.2);
  world.run(5.0);
  EXPECT_GE(world.requests, 2);
  EXPECT_EQ(world.status.state, Status::STATE_PLANNING);
  world.mapper_runs = true;
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED));
}

TEST(PlannerNode, SaysNoPathWhenNoMapComes) {
  PlannerWorld world;
  world.mapper_runs = false;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(20.0, Status::STATE_NO_PATH));
  EXPECT_THAT(world.status.cause, HasSubstr("map"));
}

TEST(PlannerNode, FindsTheWayOutFromBesideAnObstacle) {
  PlannerWorld world;
  world.robot = {0.45, 3.0, 0.0};  // 0.25 m from the wall's face
  world.go(1, 4.0, 3.2);
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED));
}

TEST(PlannerNode, KeepsItsPathWhileABitOfNoiseComesAndGoes) {
  PlannerWorld world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  const int sequence = world.path.sequence;
  for (int i = 0; i < 20; ++i) {
    world.obstacle(3.0, 4.5, 3.3, 4.8, i % 2 == 0);
    world.run(0.4);
  }
  EXPECT_EQ(world.path.sequence, sequence);
}

TEST(PlannerNode, TellsItsStateOftenEnough) {
  PlannerWorld world;
  world.run(10.0);
  EXPECT_GE(world.statuses, 9);
  world.go(1, 9.0, 3.2);
  world.run(1.0);
  const int before = world.statuses;
  world.run(5.0);
  EXPECT_GE(world.statuses - before, 25);
}

/// A planner that is killed on the way to its second stop, and the next one.
class KeptGoal : public ::testing::Test {
 protected:
  KeptGoal() {
    std::filesystem::remove_all(config_.state_folder);
    before_.emplace(config_);
    before_->send(before_->goal(8, {{3.0, 2.0}, {4.0, 1.5}}));
    EXPECT_TRUE(before_->run_until(30.0, [&] { return before_->status.pose_index == 1; }));
  }
  /// The next planner, so many seconds of the robot's time later.
  PlannerWorld& start_anew(double later = 5.0) {
    const std::int64_t utime = before_->utime;
    before_.reset();
    after_.emplace(config_);
    after_->utime = utime + static_cast<std::int64_t>(1e6 * later);
    after_->robot = {3.0, 2.0, 0.0};
    after_->run(3.0);
    return *after_;
  }
  /// It shows the goal and moves nothing, until somebody resumes it.
  void expect_asks(const std::string& why) {
    EXPECT_EQ(after_->status.state, Status::STATE_PAUSED);
    EXPECT_EQ(after_->status.goal_id, 8);
    EXPECT_EQ(after_->status.pose_index, 1);
    EXPECT_THAT(after_->status.cause, HasSubstr(why));
    EXPECT_THAT(after_->status.cause, HasSubstr("resume?"));
    EXPECT_THAT(after_->states, ::testing::Each(Status::STATE_PAUSED));
    EXPECT_EQ(after_->path.count, 0);
    after_->act(9, goal_t::ACTION_RESUME);
    EXPECT_TRUE(after_->run_until_state(30.0, Status::STATE_ARRIVED));
  }

  /// It says why, and nobody's word brings it back.
  void expect_dropped(const std::string& why) {
    PlannerWorld& world = start_anew();
    EXPECT_EQ(world.status.state, Status::STATE_NO_PATH);
    EXPECT_THAT(world.status.cause, HasSubstr("a kept goal is dropped: "));
    EXPECT_THAT(world.status.cause, HasSubstr(why));
    EXPECT_EQ(world.path.count, 0);
    world.act(20, goal_t::ACTION_RESUME);
    world.run(3.0);
    EXPECT_EQ(world.path.count, 0);
    EXPECT_FALSE(std::filesystem::exists(config_.state_folder / "goal.bin"));
  }

  PlannerConfig config_ = [] {
    PlannerConfig config;
    config.state_folder = std::filesystem::path(LUMINAV_BINARY_DIR) / "node_planner_state";
    config.building = "laboratory";
    config.boot = "first";
    return config;
  }();
  std::optional<PlannerWorld> before_;
  std::optional<PlannerWorld> after_;
};

TEST_F(KeptGoal, GoesOnAfterACrash) {
  PlannerWorld& world = start_anew();
  EXPECT_EQ(world.status.goal_id, 8);
  EXPECT_EQ(world.status.pose_index, 1);
  EXPECT_TRUE(world.run_until_state(30.0, Status::STATE_ARRIVED));
  before_.emplace(config_);
  before_->run(1.0);
  EXPECT_EQ(before_->status.state, Status::STATE_IDLE);
}

TEST_F(KeptGoal, GoesOnAfterACrashLateInALongDrive) {
  before_->motors = false;
  before_->run(300.0);
  EXPECT_NE(start_anew().status.state, Status::STATE_PAUSED);
}

TEST_F(KeptGoal, AsksAfterAnOrderlyEnd) {
  before_->node.end();
  start_anew();
  expect_asks("ended in order");
}

TEST_F(KeptGoal, AsksWhenItWasPaused) {
  before_->act(9, goal_t::ACTION_PAUSE);
  start_anew();
  expect_asks("paused");
}

TEST_F(KeptGoal, AsksAfterANewStartOfTheMachine) {
  config_.boot = "second";
  start_anew();
  expect_asks("started anew");
}

TEST_F(KeptGoal, AsksWhereTheStartOfTheMachineIsNotKnown) {
  config_.boot = "";
  start_anew();
  expect_asks("started anew");
}

TEST_F(KeptGoal, AsksTheNextMorning) {
  start_anew(14.0 * 3600.0);
  expect_asks("14 h ago");
}

TEST_F(KeptGoal, AsksWhenTheClockWentBack) {
  start_anew(-100.0);
  expect_asks("clock went back");
}

TEST_F(KeptGoal, AsksAgainWhenItCrashesWhileItAsks) {
  before_->node.end();
  start_anew();
  before_.emplace(config_);
  before_->utime = after_->utime + 5'000'000;
  before_->run(2.0);
  EXPECT_EQ(before_->status.state, Status::STATE_PAUSED);
}

TEST_F(KeptGoal, IsDroppedInAnotherBuilding) {
  config_.building = "office";
  expect_dropped("building \"laboratory\", this is \"office\"");
}

TEST_F(KeptGoal, IsDroppedWhereAZoneForbidsItMeanwhile) {
  config_.route.space.zones = {{"stairs", ZoneKind::kKeepOut, {{3.5, 1.0}, {4.5, 1.0}, {4.5, 2.0}, {3.5, 2.0}}}};
  expect_dropped("(4.0, 1.5) lies in stairs, which is a keep-out zone");
}

TEST_F(KeptGoal, IsDroppedWhereItsPlaceIsNoMore) {
  before_->act(9, goal_t::ACTION_CANCEL);
  goal_t goal = before_->goal(10, {{4.0, 1.5}});
  goal.poses[0].place = "dock";
  before_.reset();
  config_.places = {{"dock", {4.0, 1.5, 0.0}, false}};
  before_.emplace(config_);
  before_->send(goal);
  ASSERT_TRUE(before_->run_until_state(5.0, Status::STATE_FOLLOWING));
  config_.places.clear();
  expect_dropped("has no place dock");
}

TEST_F(KeptGoal, IsNoneWhereTheFileIsDamaged) {
  std::ofstream(config_.state_folder / "goal.bin") << "luminav goal 2\nfirst\nlaboratory\n";
  EXPECT_EQ(start_anew().status.state, Status::STATE_IDLE);
}

TEST_F(KeptGoal, IsNoneWhereTheFileIsCutAnywhere) {
  const GoalStore store(config_.state_folder);
  ASSERT_TRUE(store.recall());
  for (auto size = std::filesystem::file_size(config_.state_folder / "goal.bin"); size-- > 0;) {
    std::filesystem::resize_file(config_.state_folder / "goal.bin", size);
    ASSERT_FALSE(store.recall()) << size;
  }
}

}  // namespace
}  // namespace luminav
