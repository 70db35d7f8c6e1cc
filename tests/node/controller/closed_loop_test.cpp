#include "tests/node/controller/closed_loop.hpp"

#include <gtest/gtest.h>

#include <set>

namespace luminav::testing {
namespace {

ControllerConfig shipped_config() {
  return read_controller_config(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
}

// 9 x 2.4 m outside, 1.8 m wide inside
const std::vector<std::string> kCorridor{"##############################", "#............................#",
                                         "#............................#", "#............................#",
                                         "#............................#", "#............................#",
                                         "#............................#", "##############################"};

// Two rooms above a corridor, each with a door of 0.9 m.
const std::vector<std::string> kRooms{
    "##############################", "#.............#..............#", "#.............#..............#",
    "#.............#..............#", "#.............#..............#", "#.............#..............#",
    "#.............#..............#", "#.............#..............#", "#.............#..............#",
    "######...###########...#######", "#............................#", "#............................#",
    "#............................#", "#............................#", "#............................#",
    "#............................#", "##############################"};

class ClosedLoopTest : public ::testing::Test {
 protected:
  const ControllerConfig config_ = shipped_config();
};

TEST_F(ClosedLoopTest, DrivesACorridorSmoothlyInTheMiddleAndFast) {
  KinematicWorld world(config_.robot, kCorridor);
  world.place_robot({1.2, 1.2, 0.0});
  ClosedLoop loop(world, config_);
  loop.start({.goal = {8.0, 1.2}});
  ASSERT_TRUE(loop.run(40.0)) << loop.status().reason;
  EXPECT_EQ(world.contacts(), 0);
  EXPECT_LT((world.truth().position() - Eigen::Vector2d(8.0, 1.2)).norm(), 0.08);
  EXPECT_GT(loop.driven() / loop.seconds(), 0.35);
  // 3 times a second for over 2 s would be oscillation
  EXPECT_LT(loop.worst_sign_changes(), 6);
  EXPECT_GT(world.min_clearance(), 0.4);
}

TEST_F(ClosedLoopTest, TakesTheFinalHeading) {
  KinematicWorld world(config_.robot, kCorridor);
  world.place_robot({4.0, 1.2, 0.0});
  ClosedLoop loop(world, config_);
  loop.start({.goal = {2.0, 1.1}, .has_theta = true, .theta = kPi / 2.0});
  ASSERT_TRUE(loop.run(40.0)) << loop.status().reason;
  EXPECT_LT(std::abs(wrap_angle(world.truth().theta - kPi / 2.0)), radians(3.0));
  EXPECT_LT((world.truth().position() - Eigen::Vector2d(2.0, 1.1)).norm(), 0.08);
}

TEST_F(ClosedLoopTest, GoesThroughTwoDoorsFromRoomToRoom) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    KinematicWorld world(config_.robot, kRooms, seed);
    world.place_robot({1.0, 4.0, kPi / 2.0});
    ClosedLoop loop(world, config_);
    loop.start({.goal = {8.0, 4.0}});
    ASSERT_TRUE(loop.run(90.0)) << loop.status().reason;
    EXPECT_EQ(world.contacts(), 0);
    EXPECT_GT(loop.driven() / loop.seconds(), 0.22);
    EXPECT_LT(loop.worst_sign_changes(), 7);
  }
}

TEST_F(ClosedLoopTest, GoesRoundABoxThatNoMapKnows) {
  for (const double turn : {0.0, 0.4, 0.8}) {
    KinematicWorld world(config_.robot, kCorridor);
    world.place_robot({1.0, 1.2, 0.0});
    world.add_box({4.5, 1.5}, 0.5, 0.4, turn);
    ClosedLoop loop(world, config_);
    loop.start({.goal = {8.0, 1.2}, .sees_boxes = false});
    ASSERT_TRUE(loop.run(80.0)) << loop.status().reason;
    EXPECT_EQ(world.contacts(), 0);
  }
}

TEST_F(ClosedLoopTest, LetsAPersonCross) {
  for (const double start : {0.0, 2.0, 4.0, 6.0}) {
    KinematicWorld world(config_.robot, kRooms);
    world.place_robot({1.0, 1.2, 0.0});
    // out of one door and back, right through the way
    world.add_walker({.from = {2.25, 4.0}, .to = {2.25, 0.6}, .wait_until = start, .position = {2.25, 4.0}});
    ClosedLoop loop(world, config_);
    loop.start({.goal = {8.0, 1.2}});
    ASSERT_TRUE(loop.run(90.0)) << loop.status().reason;
    EXPECT_EQ(world.contacts(), 0);
  }
}

TEST_F(ClosedLoopTest, NeverTouchesSomebodyWhoWalksIntoIt) {
  for (const double lane : {0.9, 1.2, 1.5}) {
    KinematicWorld world(config_.robot, kCorridor);
    world.place_robot({1.0, 1.2, 0.0});
    world.add_walker({.from = {8.0, lane}, .to = {1.0, lane}, .position = {8.0, lane}});
    ClosedLoop loop(world, config_);
    loop.start({.goal = {8.0, 1.2}});
    loop.run(40.0);
    EXPECT_EQ(world.contacts(), 0) << lane;
    EXPECT_GT(loop.time_in(control_status_t::STATE_YIELDING), 1.0);
  }
}

TEST_F(ClosedLoopTest, ComesOutOfADeadEnd) {
  // 1.2 m wide, closed ahead and on both sides: nose to the wall, goal behind
  const std::vector<std::string> dead_end{"###############", "#..............", "#..............",
                                          "#..............", "#..............", "###############"};
  KinematicWorld world(config_.robot, dead_end);
  world.place_robot({0.58, 0.9, kPi});
  ClosedLoop loop(world, config_);
  loop.start({.goal = {3.5, 0.9}});
  EXPECT_TRUE(loop.run(60.0)) << loop.status().reason;
  EXPECT_EQ(world.contacts(), 0);
}

TEST_F(ClosedLoopTest, LeavesAUShapedTrapOnceTheMapHasIt) {
  KinematicWorld world(config_.robot, kRooms);
  world.place_robot({3.0, 1.2, 0.0});
  // open to the west, its back across the way
  world.add_box({5.4, 1.2}, 0.1, 1.0);
  world.add_box({5.0, 0.72}, 0.8, 0.1);
  world.add_box({5.0, 1.72}, 0.8, 0.1);
  ClosedLoop loop(world, config_);
  loop.start({.goal = {8.0, 1.5}, .sees_boxes = false});
  loop.run(20.0);
  EXPECT_EQ(world.contacts(), 0);
  EXPECT_LT(world.truth().x, 5.4);
  // now mapper and planner take their part: the trap's south side leaves no room, the north has
  loop.start({.goal = {1.0, 1.2}});
  EXPECT_TRUE(loop.run(60.0)) << loop.status().reason;
  EXPECT_EQ(world.contacts(), 0);
}

TEST_F(ClosedLoopTest, SaysThatItIsStuckWhereTheWayIsWalledOff) {
  KinematicWorld world(config_.robot, kCorridor);
  world.place_robot({2.0, 1.2, 0.0});
  world.add_box({4.5, 1.2}, 0.3, 1.8);
  ClosedLoop loop(world, config_);
  loop.start({.goal = {8.0, 1.2}, .sees_boxes = false});
  EXPECT_FALSE(loop.run(60.0));
  EXPECT_EQ(world.contacts(), 0);
  EXPECT_GT(loop.time_in(control_status_t::STATE_STUCK), 3.0);
  EXPECT_FALSE(loop.status().reason.empty());
}

TEST_F(ClosedLoopTest, WandersOverTheGroundWithoutTouchingWhereTheBuildingAllowsIt) {
  ControllerConfig config = config_;
  config.building.search = SearchManner::kWander;
  for (const unsigned seed : {1U, 2U, 3U}) {
    KinematicWorld world(config_.robot, kRooms, seed);
    world.place_robot({2.0, 4.0, 0.7 * seed});
    world.add_walker({.from = {1.0, 1.2}, .to = {8.0, 1.2}, .position = {1.0, 1.2}});
    ClosedLoop loop(world, config);
    loop.localize();
    loop.run(90.0);
    EXPECT_EQ(world.contacts(), 0);
    EXPECT_GT(loop.driven(), 9.0);
    std::set<std::pair<int, int>> squares;
    for (const Eigen::Vector2d& place : loop.track()) {
      squares.insert({static_cast<int>(place.x()), static_cast<int>(place.y())});
    }
    EXPECT_GE(squares.size(), 5U);
  }
}

TEST_F(ClosedLoopTest, SameInputsGiveTheSameCommands) {
  std::vector<std::pair<double, double>> commands[2];
  for (auto& record : commands) {
    KinematicWorld world(config_.robot, kRooms);
    world.place_robot({1.0, 4.0, 0.0});
    ClosedLoop loop(world, config_);
    loop.start({.goal = {8.0, 1.2}});
    for (int i = 0; i < 500; ++i) {
      loop.tick();
      record.emplace_back(loop.command_message().linear_x, loop.command_message().angular_z);
    }
  }
  EXPECT_EQ(commands[0], commands[1]);
}

}  // namespace
}  // namespace luminav::testing
