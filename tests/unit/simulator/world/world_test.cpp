#include "drivers/simulator/world/world.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/simulator/world/lamp_state.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

const MotorCommand kStand{0.0, 0.0, true};
const MotorCommand kForward{0.4, 0.0, true};
const MotorCommand kBackward{-0.4, 0.0, true};

/// A hall that is free from 0.5 to 10.5 and from 0.5 to 6.5.
constexpr std::uint64_t kSeed = 1;

WorldTruth truth_at(const Pose2& start, const std::vector<ScenarioEvent>& events = {}) {
  WorldTruth truth = exact_truth(map_from_text(hall(20, 12)), start);
  truth.events = events;
  return truth;
}

ScenarioEvent event(double at, EventKind kind) {
  ScenarioEvent result;
  result.at = at;
  result.kind = kind;
  return result;
}

struct Travel {
  double left = 0.0;
  double right = 0.0;
  int stalled = 0;  // ticks
};

Travel run(World& world, const MotorCommand& command, double seconds) {
  Travel travel;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / World::kTick)); ++i) {
    const WheelReport report = world.step(command);
    travel.left += report.left;
    travel.right += report.right;
    travel.stalled += report.stalled ? 1 : 0;
  }
  return travel;
}

TEST(World, DrivesWhereTheWheelsSay) {
  World world(kSeed, truth_at({3.0, 3.0, 0.5 * kPi}));
  const Travel travel = run(world, kForward, 3.0);
  EXPECT_NEAR(world.state().world_from_robot.y, 3.0 + travel.left, 1e-9);
  EXPECT_NEAR(world.state().linear, 0.4, 1e-3);
  EXPECT_NEAR(world.state().angular, 0.0, 1e-9);
  EXPECT_EQ(world.contacts().contacts(), 0);
}

TEST(World, StopsAtAWallCountsOneContactAndStallsOrSpins) {
  int spins = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    World world(seed, truth_at({9.0, 3.0, 0.0}));
    const Travel travel = run(world, kForward, 10.0);
    EXPECT_NEAR(world.state().world_from_robot.x + 0.21, 10.5, 0.005);
    EXPECT_LE(world.state().world_from_robot.x + 0.21, 10.5);
    EXPECT_EQ(world.contacts().contacts(), 1);
    EXPECT_TRUE(world.contacts().touching());
    EXPECT_EQ(world.state().linear, 0.0);
    const bool spun = travel.left > 3.5;
    spins += spun ? 1 : 0;
    EXPECT_EQ(travel.stalled > 100, !spun);
  }
  EXPECT_GT(spins, 4);
  EXPECT_LT(spins, 25);
}

TEST(World, CountsAnotherContactOnlyAfterSeparation) {
  World world(kSeed, truth_at({10.0, 3.0, 0.0}));
  run(world, kForward, 3.0);
  run(world, kStand, 1.0);
  run(world, kForward, 1.0);
  EXPECT_EQ(world.contacts().contacts(), 1);
  run(world, kBackward, 1.0);
  EXPECT_FALSE(world.contacts().touching());
  run(world, kForward, 3.0);
  EXPECT_EQ(world.contacts().contacts(), 2);
}

TEST(World, FeelsTheRearCornerSwingIntoAWall) {
  // along the wall with 5 cm of room: the right rear corner, 0.37 m from the axis, swings out when turning left
  World world(kSeed, truth_at({5.0, 0.5 + 0.2125 + 0.05, 0.0}));
  EXPECT_NEAR(world.state().clearance, 0.05, 1e-6);
  run(world, {0.0, 0.6, true}, 3.0);
  EXPECT_EQ(world.contacts().contacts(), 1);
  EXPECT_LT(world.state().world_from_robot.theta, 0.3);
  // with 20 cm more it turns freely
  World free(kSeed, truth_at({5.0, 0.5 + 0.38, 0.0}));
  run(free, {0.0, 0.6, true}, 12.0);
  EXPECT_EQ(free.contacts().contacts(), 0);
}

TEST(World, CountsHardObstaclesApart) {
  WorldTruth truth = truth_at({3.0, 3.0, 0.0});
  truth.obstacles = {{Pose2{4.5, 3.0, 0.0}, 0.4, 0.4, ObstacleKind::kTable}};
  World world(kSeed, truth);
  run(world, kForward, 5.0);
  EXPECT_EQ(world.contacts().contacts(), 0);
  EXPECT_EQ(world.contacts().hard_contacts(), 1);
}

/// Of a Create 2 that drives at a walk; the reports of all ticks put together.
WheelReport felt(World& world, const MotorCommand& command, double seconds) {
  WheelReport all;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / World::kTick)); ++i) {
    const WheelReport report = world.step(command);
    all.bumpers |= report.bumpers;
    all.cliffs |= report.cliffs;
    all.drop_left |= report.drop_left;
    all.drop_right |= report.drop_right;
  }
  return all;
}

TEST(World, LetsABumperFeelWhatItTouchesAndCountsItApart) {
  for (const double speed : {0.2, 0.4}) {
    WorldTruth truth = truth_at({9.9, 3.0, 0.0});
    truth.feels_touch = true;
    World world(kSeed, truth);
    EXPECT_EQ(felt(world, {speed, 0.0, true}, 0.5).bumpers, 0);
    EXPECT_EQ(felt(world, {speed, 0.0, true}, 4.0).bumpers, 3) << "a wall ahead: both sides";
    EXPECT_EQ(world.contacts().hard_contacts(), speed < 0.25 ? 1 : 0);
    EXPECT_EQ(world.contacts().contacts(), speed < 0.25 ? 0 : 1) << "no walk any more";
  }
}

TEST(World, LetsCliffSensorsSeeAHoleBeforeAWheelIsInIt) {
  WorldTruth truth = truth_at({3.0, 3.0, 0.0});
  truth.feels_touch = true;
  truth.holes = {rectangle({4.5, 3.0, 0.0}, 1.0, 4.0)};
  World world(kSeed, truth);
  EXPECT_EQ(felt(world, {0.2, 0.0, true}, 4.0).cliffs, 0) << "at 3.8";
  const WheelReport near = felt(world, {0.2, 0.0, true}, 0.6);
  EXPECT_NE(near.cliffs, 0);
  EXPECT_FALSE(near.drop_left || near.drop_right);
  EXPECT_EQ(world.contacts().contacts(), 0);
  const WheelReport in = felt(world, {0.2, 0.0, true}, 1.0);
  EXPECT_TRUE(in.drop_left && in.drop_right);
  EXPECT_EQ(world.contacts().contacts(), 1) << "it fell";
}

TEST(World, TellsABaseWithoutThatSenseNothing) {
  WorldTruth truth = truth_at({9.9, 3.0, 0.0});
  truth.holes = {rectangle({9.9, 3.0, 0.0}, 1.0, 1.0)};
  World world(kSeed, truth);
  const WheelReport all = felt(world, {0.2, 0.0, true}, 4.0);
  EXPECT_EQ(all.bumpers | all.cliffs, 0);
  EXPECT_EQ(world.contacts().contacts(), 1);
}

TEST(World, LetsPeopleWalkToAndFroAndStopBeforeTheRobot) {
  WorldTruth truth = truth_at({5.0, 3.0, 0.0});
  truth.people = {{{{1.0, 3.0}, {9.0, 3.0}}, 0.8}, {{{1.0, 5.5}, {3.0, 5.5}}, 1.0}};
  World world(kSeed, truth);
  run(world, kStand, 1.0);
  EXPECT_NEAR(world.people()[0].centre.x(), 1.8, 0.01);
  run(world, kStand, 3.5);
  // 0.1 m before the rear of the robot, within one step
  EXPECT_NEAR(5.0 - 0.301 - (world.people()[0].centre.x() + kPersonRadius), 0.1, 0.009);
  EXPECT_GE(world.state().clearance, 0.1);
  EXPECT_EQ(world.contacts().contacts(), 0);
  run(world, kStand, 5.0);
  EXPECT_LT(world.people()[0].centre.y(), 2.5);  // gives way
  run(world, kStand, 7.0);
  EXPECT_LT(world.people()[0].centre.x(), 3.5);          // lost patience and went back
  EXPECT_NEAR(world.people()[1].centre.x(), 1.42, 0.1);  // 16.5 m of to and fro
}

TEST(World, LetsAPersonGoOnWhenTheRobotClearsTheWay) {
  WorldTruth truth = truth_at({5.0, 3.0, 0.5 * kPi});
  truth.people = {{{{1.0, 3.0}, {9.0, 3.0}}, 0.8}};
  World world(kSeed, truth);
  run(world, kStand, 6.0);
  const double waiting = world.people()[0].centre.x();
  EXPECT_LT(waiting, 4.6);
  run(world, kForward, 5.0);
  EXPECT_GT(world.people()[0].centre.x(), 6.0);
  EXPECT_EQ(world.contacts().contacts(), 0);
}

TEST(World, CountsAContactWithAPersonThatTheRobotDrivesInto) {
  WorldTruth truth = truth_at({3.0, 3.0, 0.0});
  truth.people = {{{{4.5, 3.0}, {4.5, 3.0}}, 0.0}};
  World world(kSeed, truth);
  run(world, kForward, 5.0);
  EXPECT_EQ(world.contacts().contacts(), 1);
  EXPECT_LE(world.state().world_from_robot.x + 0.21 + kPersonRadius, 4.5);
}

TEST(ContactCounter, ExcusesARobotThatHadStoodStill) {
  Separation touching;
  touching.of[static_cast<std::size_t>(SolidKind::kPerson)] = 0.0;
  ContactCounter standing;
  for (int i = 0; i < 60; ++i) {
    standing.observe_motion(0.01, 0.01, 0.01);
  }
  EXPECT_TRUE(standing.touch(touching));
  EXPECT_EQ(standing.contacts(), 0);
  ContactCounter moving;
  for (int i = 0; i < 60; ++i) {
    moving.observe_motion(0.01, 0.01, 0.05);
  }
  moving.touch(touching);
  EXPECT_EQ(moving.contacts(), 1);
  ContactCounter briefly;
  for (int i = 0; i < 40; ++i) {
    briefly.observe_motion(0.01, 0.0, 0.0);
  }
  briefly.touch(touching);
  EXPECT_EQ(briefly.contacts(), 1);
}

TEST(ContactCounter, CountsAFallOnce) {
  ContactCounter counter;
  for (const bool hangs : {false, true, true, false, true}) {
    counter.observe_fall(hangs);
  }
  EXPECT_EQ(counter.contacts(), 2);
}

TEST(World, CarriesTheRobotWithoutTurningItsWheels) {
  std::vector<ScenarioEvent> events = {event(1.0, EventKind::kCarry)};
  events[0].pose = {8.0, 5.0, 1.0};
  events[0].duration = 2.0;
  World world(kSeed, truth_at({3.0, 3.0, 0.0}, events));
  run(world, kForward, 0.99);
  EXPECT_FALSE(world.state().carried);
  const Travel travel = run(world, kForward, 2.0);
  EXPECT_TRUE(world.state().carried);
  EXPECT_EQ(world.state().carries, 1);
  EXPECT_EQ(travel.left, 0.0);
  EXPECT_EQ(world.state().clearance, Separation::kNoneNear);
  run(world, kStand, 0.1);
  EXPECT_FALSE(world.state().carried);
  EXPECT_NEAR(world.state().world_from_robot.x, 8.0, 1e-9);
  EXPECT_NEAR(world.state().world_from_robot.theta, 1.0, 1e-9);
  EXPECT_GT(run(world, kForward, 1.0).left, 0.3);
  EXPECT_EQ(world.contacts().contacts(), 0);
}

TEST(World, SlipsForAWhile) {
  std::vector<ScenarioEvent> events = {event(1.0, EventKind::kSlip)};
  events[0].factor = 0.5;
  events[0].duration = 2.0;
  World world(kSeed, truth_at({1.0, 3.0, 0.0}, events));
  run(world, kForward, 0.99);
  const double before = world.state().world_from_robot.x;
  const Travel slipping = run(world, kForward, 2.0);
  EXPECT_NEAR(world.state().world_from_robot.x - before, 0.5 * slipping.left, 1e-9);
  const double after = world.state().world_from_robot.x;
  const Travel gripping = run(world, kForward, 1.0);
  EXPECT_NEAR(world.state().world_from_robot.x - after, gripping.left, 1e-9);
}

TEST(World, BumpsTheRobotAsideButNotThroughWalls) {
  std::vector<ScenarioEvent> events = {event(0.5, EventKind::kBump)};
  events[0].pose = {0.1, -0.05, 0.3};
  World world(kSeed, truth_at({3.0, 3.0, 0.0}, events));
  const Travel travel = run(world, kStand, 2.0);
  EXPECT_EQ(travel.left, 0.0);
  EXPECT_NEAR(world.state().world_from_robot.x, 3.1, 1e-9);
  EXPECT_NEAR(world.state().world_from_robot.y, 2.95, 1e-9);
  EXPECT_NEAR(world.state().world_from_robot.theta, 0.3, 1e-9);
  World near_wall(kSeed, truth_at({10.5 - 0.21 - 0.05, 3.0, 0.0}, events));
  run(near_wall, kStand, 2.0);
  EXPECT_LE(near_wall.state().world_from_robot.x + 0.21, 10.5);
  EXPECT_EQ(near_wall.contacts().contacts(), 0);  // not the robot's doing
}

TEST(World, ChangesLightLampsAndPlugs) {
  std::vector<ScenarioEvent> events = {event(0.3, EventKind::kUnplug), event(0.1, EventKind::kLight),
                                       event(0.2, EventKind::kLamp), event(0.25, EventKind::kLamp),
                                       event(0.4, EventKind::kUnplug)};
  events[0].device = "camera";
  events[0].duration = 0.5;
  events[1].daylight = 0.9;
  events[1].off = {11};
  events[2].id = 12;
  events[2].pose = {0.3, 0.0, 0.1};
  events[3] = events[2];
  events[4].device = "serial";
  events[4].duration = 0.2;
  WorldTruth truth = truth_at({3.0, 3.0, 0.0}, events);
  truth.building.fixtures.resize(2);
  truth.building.fixtures[0].id = 11;
  truth.building.fixtures[1].id = 12;
  truth.lamp_states = {kLampOn, kLampOn};
  World world(kSeed, truth);
  EXPECT_EQ(world.state().daylight, 0.5);
  run(world, kStand, 0.5);
  EXPECT_EQ(world.state().daylight, 0.9);
  EXPECT_EQ(world.state().lamp_states[0], kLampOff);
  EXPECT_EQ(world.state().lamp_states[1], kLampOn);
  ASSERT_EQ(world.state().lamp_offsets.size(), 1U);
  EXPECT_NEAR(world.state().lamp_offsets.at(1).x, 0.6, 1e-12);  // two events add up
  EXPECT_TRUE(world.state().camera_unplugged);
  EXPECT_TRUE(world.state().serial_unplugged);
  run(world, kStand, 0.2);
  EXPECT_FALSE(world.state().serial_unplugged);
  EXPECT_TRUE(world.state().camera_unplugged);
  run(world, kStand, 0.2);
  EXPECT_FALSE(world.state().camera_unplugged);
}

TEST(World, ClosesADoorOnlyWhenNobodyStandsInIt) {
  std::vector<ScenarioEvent> events = {event(0.5, EventKind::kDoor), event(20.0, EventKind::kDoor)};
  events[0].id = events[1].id = 3;
  events[0].open = false;
  WorldTruth truth = truth_at({5.0, 3.0, 0.0}, events);
  truth.building.doors = {{3, {5.0, 3.0, 0.5 * kPi}, 1.0}};
  World world(kSeed, truth);
  run(world, kStand, 2.0);
  EXPECT_TRUE(world.state().door_open[0]);
  run(world, kForward, 3.0);
  EXPECT_FALSE(world.state().door_open[0]);
  run(world, kBackward, 5.0);
  EXPECT_EQ(world.contacts().contacts(), 1);  // backed into the closed door
  EXPECT_GT(world.state().world_from_robot.x, 5.3);
  run(world, kStand, 11.0);
  EXPECT_TRUE(world.state().door_open[0]);
}

TEST(World, IsTheSameForTheSameSeedAndCommands) {
  WorldTruth truth = truth_at({3.0, 3.0, 0.0});
  truth.wheels.noise_position = 0.01;
  truth.wheels.noise_heading = 0.01;
  truth.floor_tilt = 0.002;
  truth.people = {{{{1.0, 1.0}, {9.0, 5.0}}, 0.8}};
  World first(4, truth);
  World second(4, truth);
  for (int i = 0; i < 3000; ++i) {
    const MotorCommand command{0.3, std::sin(0.01 * i), true};
    first.step(command);
    second.step(command);
    if (i % 4 == 0) {
      ASSERT_EQ(first.measure_sonar(0), second.measure_sonar(0));
    }
  }
  EXPECT_EQ(first.state().world_from_robot.x, second.state().world_from_robot.x);
  EXPECT_EQ(first.state().world_from_robot.theta, second.state().world_from_robot.theta);
  EXPECT_EQ(first.state().roll, second.state().roll);
  EXPECT_NE(first.state().roll, 0.0);
}

// However it is driven, the robot never gets into what is solid, and always gets away again.
TEST(World, NeverPenetratesAnything) {
  WorldTruth truth = exact_truth(map_from_text(hall(8, 8)), {2.5, 2.5, 0.0});
  truth.wheels.noise_position = 0.01;
  truth.wheels.noise_heading = 0.01;
  truth.obstacles = {{Pose2{1.5, 3.5, 0.4}, 0.5, 0.4, ObstacleKind::kBox},
                     {Pose2{3.6, 1.5, 0.0}, 0.4, 0.4, ObstacleKind::kLegs}};
  truth.people = {{{{1.0, 1.0}, {4.0, 4.0}}, 0.8}};
  World world(kSeed, truth);
  RandomStream random(8, "drive");
  MotorCommand command;
  double travel = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    if (i % 150 == 0) {
      command = {random.uniform(-0.6, 0.6), random.uniform(-1.5, 1.5), true};
    }
    const Pose2 before = world.state().world_from_robot;
    world.step(command);
    ASSERT_GT(world.state().clearance, 0.0) << "at " << world.time() << " s";
    travel += distance(before, world.state().world_from_robot);
  }
  EXPECT_GT(travel, 20.0);
  EXPECT_GT(world.contacts().contacts(), 10);
}

TEST(World, DeafensAndSticksTheDiscsThatAnEventNames) {
  std::vector<ScenarioEvent> events = {event(0.5, EventKind::kDeafen), event(0.5, EventKind::kStick)};
  events[0].discs = {0};
  events[0].duration = 1.0;
  events[1].discs = {1};
  events[1].duration = 1.0;
  WorldTruth truth = truth_at({8.0, 3.0, 0.0}, events);
  truth.robot.sonar.robot_from_sonar.assign(2, Pose2{});
  World world(kSeed, truth);
  const double before = world.measure_sonar(1);
  EXPECT_LT(world.measure_sonar(0), truth.robot.sonar.maximum_range);
  run(world, kForward, 1.2);
  EXPECT_EQ(world.measure_sonar(0), truth.robot.sonar.maximum_range);
  EXPECT_EQ(world.measure_sonar(1), before);
  run(world, kStand, 1.0);
  EXPECT_LT(world.measure_sonar(0), truth.robot.sonar.maximum_range);
  EXPECT_NE(world.measure_sonar(1), before);
}

TEST(World, FreezesAnEncoderWhileItsWheelTurnsOn) {
  std::vector<ScenarioEvent> events = {event(1.0, EventKind::kFreeze)};
  events[0].device = "encoder_left";
  events[0].duration = 1.0;
  World world(kSeed, truth_at({3.0, 3.0, 0.0}, events));
  run(world, kForward, 0.99);
  const double before = world.state().world_from_robot.x;
  const Travel frozen = run(world, kForward, 1.0);
  EXPECT_EQ(frozen.left, 0.0);
  EXPECT_GT(frozen.right, 0.3);
  EXPECT_GT(world.state().world_from_robot.x - before, 0.3);
  EXPECT_GT(run(world, kForward, 1.0).left, 0.3);
}

}  // namespace
}  // namespace luminav
