#include "services/controller/controller_node.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/node/controller/closed_loop.hpp"

namespace luminav::testing {
namespace {

const std::vector<std::string> kHall{"####################", "#..................#", "#..................#",
                                     "#..................#", "#..................#", "#..................#",
                                     "#..................#", "#..................#", "#..................#",
                                     "####################"};

class ControllerNodeTest : public ::testing::Test {
 protected:
  ControllerNodeTest() { world_.place_robot({1.0, 1.5, 0.0}); }

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(50.0 * seconds); ++i) {
      loop_.tick();
    }
  }
  void drive_off() {
    loop_.start({.goal = {5.0, 1.5}});
    run(2.0);
    ASSERT_GT(loop_.command_message().linear_x, 0.2);
  }
  void expect_standing(const std::string& reason) {
    EXPECT_DOUBLE_EQ(loop_.command_message().linear_x, 0.0);
    EXPECT_DOUBLE_EQ(loop_.command_message().angular_z, 0.0);
    EXPECT_NE(loop_.status().reason.find(reason), std::string::npos) << loop_.status().reason;
  }
  void stop(std::int64_t id, bool engaged, const std::string& sender = "viewer") {
    stop_t message{};
    message.id = id;
    message.engaged = engaged;
    message.sender = sender;
    loop_.lcm().publish(channels::kStop, &message);
  }
  void limit_speed(double max_speed) {
    speed_limit_t message{};
    message.utime = loop_.utime();
    message.max_speed = max_speed;
    message.sender = "jobs";
    loop_.lcm().publish(channels::kSpeedLimit, &message);
  }
  void teleoperate(int sequence, double linear, double angular) {
    teleop_command_t message{};
    message.utime = loop_.utime();
    message.session = 5;
    message.sequence = sequence;
    message.linear = linear;
    message.angular = angular;
    loop_.lcm().publish(channels::kTeleopCommand, &message);
  }

  /// What the localizer says when a picture, of that time [us], has told more.
  void correct_pose(std::int64_t picture, double turn, std::int8_t state = pose_t::STATE_TRACKING) {
    pose_t pose{};
    pose.utime = loop_.utime() / 100'000 * 100'000;  // of the newest odometry
    pose.session = 7;
    pose.state = state;
    pose.x = world_.truth().x;
    pose.y = world_.truth().y;
    pose.theta = world_.truth().theta + turn;
    pose.fixture_utime = picture;
    loop_.lcm().publish(channels::kPose, &pose);
    while (loop_.lcm().handleTimeout(0) > 0) {
    }
  }

  ControllerConfig config_ = read_controller_config(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
  KinematicWorld world_{config_.robot, kHall};
  ClosedLoop loop_{world_, config_};
};

TEST_F(ControllerNodeTest, AnswersEachTickWithItsStampAndAGrowingSequence) {
  loop_.tick();
  const velocity_command_t first = loop_.command_message();
  EXPECT_EQ(first.utime, loop_.utime());
  EXPECT_EQ(first.session, first.utime);
  loop_.tick();
  EXPECT_EQ(loop_.command_message().utime, loop_.utime());
  EXPECT_EQ(loop_.command_message().session, first.session);
  EXPECT_EQ(loop_.command_message().sequence, first.sequence + 1);
}

TEST_F(ControllerNodeTest, StandsStillWithoutAGoal) {
  run(1.0);
  expect_standing("no goal yet");
}

TEST_F(ControllerNodeTest, FollowsAndArrivesOnce) {
  loop_.start({.goal = {4.0, 1.5}});
  ASSERT_TRUE(loop_.run(30.0));
  run(3.0);
  EXPECT_EQ(loop_.status().state, control_status_t::STATE_AT_GOAL);
  EXPECT_DOUBLE_EQ(loop_.command_message().linear_x, 0.0);
}

TEST_F(ControllerNodeTest, FollowsItsPathForThreeSecondsAfterThePlannersLastWord) {
  drive_off();
  loop_.drops_plan = true;
  run(2.7);
  EXPECT_GT(loop_.command_message().linear_x, 0.2) << "one that crashed is back by then";
  run(1.3);  // and it brakes from 0.5 m/s
  expect_standing("the planner is silent");
  loop_.drops_plan = false;
  run(1.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.1);
}

TEST_F(ControllerNodeTest, AnswersAPoseThatAPictureCorrectedAtOnce) {
  drive_off();
  for (int ticks = 0; ticks < 2; ++ticks) {  // with a step of control at the newest tick, and without
    loop_.tick();
    const velocity_command_t before = loop_.command_message();
    correct_pose(loop_.utime() - 60'000, 0.3);
    const velocity_command_t after = loop_.command_message();
    EXPECT_EQ(after.sequence, before.sequence + 1);
    EXPECT_EQ(after.utime, before.utime) << "the stamp of the newest tick: the driver judges its age";
    EXPECT_LT(after.angular_z, before.angular_z - 0.02) << "it heads left of its path";
    correct_pose(loop_.utime() - 60'000, 0.3);
    EXPECT_EQ(loop_.command_message().sequence, after.sequence) << "no news";
    run(2.0);
  }
}

TEST_F(ControllerNodeTest, SlowsDownAtOnceWhenAPictureLosesThePose) {
  drive_off();
  const velocity_command_t before = loop_.command_message();
  correct_pose(loop_.utime() - 60'000, 0.0, pose_t::STATE_LOST);
  EXPECT_EQ(loop_.command_message().sequence, before.sequence + 1);
  EXPECT_LT(loop_.command_message().linear_x, before.linear_x - 0.01);
}

TEST_F(ControllerNodeTest, LeavesAPoseToTheNextTickWhereItStands) {
  run(1.0);
  const velocity_command_t before = loop_.command_message();
  correct_pose(loop_.utime() - 60'000, 0.3);
  EXPECT_EQ(loop_.command_message().sequence, before.sequence);
}

TEST_F(ControllerNodeTest, DrivesNoFasterThanSomebodyAsksForAndForgetsItInASecond) {
  drive_off();
  const double free = loop_.command_message().linear_x;
  for (int i = 0; i < 5; ++i) {
    limit_speed(0.15);
    run(0.2);
  }
  EXPECT_LE(loop_.command_message().linear_x, 0.15 + 1e-9);
  EXPECT_EQ(loop_.status().reason, "slow for jobs");
  limit_speed(2.0);  // upwards it moves nothing
  run(1.0);
  EXPECT_NEAR(loop_.command_message().linear_x, free, 0.1);
  limit_speed(0.15);
  run(0.9);
  EXPECT_LE(loop_.command_message().linear_x, 0.15 + 1e-9);
  run(1.1);
  EXPECT_GT(loop_.command_message().linear_x, 0.2) << "who asked has fallen silent";
}

TEST_F(ControllerNodeTest, HearsNoSpeedLimitThatNobodyDrivesBy) {
  drive_off();
  const std::int64_t dropped = loop_.node().health().dropped_inputs;
  for (const double speed : {0.0, -0.2, 100.0}) {
    limit_speed(speed);
  }
  run(0.5);
  EXPECT_EQ(loop_.node().health().dropped_inputs, dropped + 3);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
}

TEST_F(ControllerNodeTest, StaysStoppedWhateverPicturesTell) {
  drive_off();
  stop(17, true);
  correct_pose(loop_.utime() - 60'000, 0.3);
  EXPECT_DOUBLE_EQ(loop_.command_message().linear_x, 0.0);
  EXPECT_DOUBLE_EQ(loop_.command_message().angular_z, 0.0);
}

TEST_F(ControllerNodeTest, ObeysStopAndEchoesIt) {
  drive_off();
  stop(17, true);
  run(0.2);
  expect_standing("stop");
  EXPECT_TRUE(loop_.status().stop_engaged);
  EXPECT_EQ(loop_.status().stop_id, 17);
  stop(16, false);  // an old release
  run(0.5);
  expect_standing("stop");
  stop(18, false);
  run(2.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
  EXPECT_EQ(loop_.status().stop_id, 18);
}

TEST_F(ControllerNodeTest, ComparesStopsOfOneSenderOnly) {
  drive_off();
  stop(1000, true, "desk");
  run(0.2);
  expect_standing("stop");
  stop(5, false, "tablet");  // whose clock is behind
  run(2.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
  EXPECT_EQ(loop_.status().stop_id, 5);
}

TEST_F(ControllerNodeTest, ObeysAStopThatHasTheIdOfARelease) {
  drive_off();
  stop(100, true, "viewer");
  stop(101, false, "viewer");
  run(2.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
  stop(101, true, "viewer");  // two pages counted on from the same id
  run(0.5);
  expect_standing("stop");
  EXPECT_TRUE(loop_.status().stop_engaged);
}

TEST_F(ControllerNodeTest, BeginsANewSessionWhenTheRobotsClockGoesBack) {
  run(10.0);
  const std::int64_t session = loop_.command_message().session;
  loop_.step_clock(-3600.0);
  run(1.0);
  EXPECT_LT(loop_.command_message().session, session);
  EXPECT_LE(loop_.command_message().session, loop_.command_message().utime) << "the driver refuses it otherwise";
  const velocity_command_t before = loop_.command_message();
  run(1.0);
  EXPECT_EQ(loop_.command_message().session, before.session);
  EXPECT_GT(loop_.command_message().sequence, before.sequence);
}

TEST_F(ControllerNodeTest, ForgetsThePoseWhenTheRobotsClockGoesBack) {
  drive_off();
  loop_.drops_pose = true;
  loop_.step_clock(-3600.0);
  run(3.0);
  expect_standing("the localizer has not spoken yet");
  loop_.drops_pose = false;
  run(3.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
}

TEST_F(ControllerNodeTest, DropsPosesAheadOfTheOdometry) {
  drive_off();
  loop_.drops_pose = true;
  const std::int64_t before = loop_.node().health().dropped_inputs;
  pose_t pose{};
  pose.utime = loop_.utime() + 3'600'000'000;
  pose.session = 7;
  pose.state = pose_t::STATE_TRACKING;
  pose.x = world_.truth().x;
  pose.y = world_.truth().y;
  loop_.lcm().publish(channels::kPose, &pose);
  run(3.0);
  expect_standing("the pose is");
  EXPECT_EQ(loop_.node().health().dropped_inputs - before, 1);
}

TEST_F(ControllerNodeTest, DropsRangesAheadOfTheOdometry) {
  drive_off();
  loop_.drops_sonar = true;
  const std::int64_t before = loop_.node().health().dropped_inputs;
  sonar_t sonar{};
  sonar.utime = loop_.utime();
  sonar.session = 7;
  sonar.count = 16;
  sonar.range.assign(16, 4.0F);
  sonar.has_echo.assign(16, 1);
  sonar.fresh.assign(16, 1);
  sonar.range_utime.assign(16, loop_.utime() + 3'600'000'000);
  loop_.lcm().publish(channels::kSonar, &sonar);
  run(1.5);
  EXPECT_EQ(loop_.node().health().dropped_inputs - before, 16);
  EXPECT_DOUBLE_EQ(loop_.command_message().linear_x, 0.0) << "the sonars are silent";
  loop_.drops_sonar = false;
  run(2.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
}

TEST_F(ControllerNodeTest, StopsWhenThePoseIsLostOrOld) {
  drive_off();
  loop_.is_tracking = false;
  run(0.6);
  EXPECT_LT(loop_.command_message().linear_x, 0.2);
  run(1.0);
  expect_standing("pose is not known");
  loop_.is_tracking = true;
  run(2.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
  loop_.drops_pose = true;
  run(2.0);
  expect_standing("pose is");
}

TEST_F(ControllerNodeTest, StopsWhenTheSonarsFallSilent) {
  drive_off();
  loop_.drops_sonar = true;
  run(1.5);
  EXPECT_DOUBLE_EQ(loop_.command_message().linear_x, 0.0);
  EXPECT_DOUBLE_EQ(loop_.command_message().angular_z, 0.0);
}

TEST_F(ControllerNodeTest, CountsNoSonarAsImpossibleThatFiredBeforeItListened) {
  lcm::LCM lcm("memq://");
  ControllerNode node(lcm, config_);
  constexpr std::int64_t kBegin = 1'700'000'000'000'000;  // [us]
  odometry_t odometry{};
  odometry.utime = kBegin;
  odometry.session = 1;
  lcm.publish(channels::kOdometry, &odometry);
  sonar_t sonar{};
  sonar.utime = kBegin + 10'000;
  sonar.session = 1;
  sonar.count = static_cast<std::int32_t>(config_.robot.sonar.robot_from_sonar.size());
  const auto count = static_cast<std::size_t>(sonar.count);
  sonar.range.assign(count, 2.0);
  sonar.range_utime.assign(count, kBegin - 600'000);
  sonar.fresh.assign(count, 1);
  sonar.has_echo.assign(count, 1);
  lcm.publish(channels::kSonar, &sonar);
  const auto drain = [&] {
    while (lcm.handleTimeout(0) > 0) {
    }
  };
  drain();
  EXPECT_EQ(node.health().dropped_inputs, 0);
  sonar.utime += 100'000;
  sonar.range_utime.assign(count, kBegin + 60'000'000);
  lcm.publish(channels::kSonar, &sonar);
  drain();
  EXPECT_EQ(node.health().dropped_inputs, sonar.count) << "a stamp from the future is still one";
}

TEST_F(ControllerNodeTest, CommandsNothingWhileTheMotorsAreOff) {
  drive_off();
  loop_.motors = false;
  run(0.2);
  expect_standing("motors");
}

TEST_F(ControllerNodeTest, LetsAPersonDriveWhileTheCommandsComeAndStopsAfterThem) {
  run(1.0);
  for (int i = 0; i < 50; ++i) {
    teleoperate(i, 0.3, 0.0);
    loop_.tick();
  }
  EXPECT_NEAR(loop_.command_message().linear_x, 0.3, 0.02);
  EXPECT_EQ(loop_.status().state, control_status_t::STATE_TELEOP);
  run(1.0);
  EXPECT_DOUBLE_EQ(loop_.command_message().linear_x, 0.0);
}

TEST_F(ControllerNodeTest, TeleoperationCannotDriveIntoAWall) {
  world_.place_robot({5.0, 1.5, 0.0});
  run(1.0);
  for (int i = 0; i < 500; ++i) {
    teleoperate(i, 0.5, 0.0);
    loop_.tick();
  }
  EXPECT_EQ(world_.contacts(), 0);
  EXPECT_LT(world_.clearance(), 0.3);
  EXPECT_GT(world_.clearance(), 0.03);
  EXPECT_LT(loop_.command_message().linear_x, 0.03);
  // and may be led away backwards
  for (int i = 500; i < 600; ++i) {
    teleoperate(i, -0.3, 0.0);
    loop_.tick();
  }
  EXPECT_LT(loop_.command_message().linear_x, -0.2);
}

TEST_F(ControllerNodeTest, DropsAndCountsWhatMakesNoSense) {
  drive_off();
  const std::int64_t before = loop_.node().health().dropped_inputs;
  const std::uint8_t bytes[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  for (const char* channel : {channels::kPath, channels::kPose, channels::kOdometry, channels::kSonar,
                              channels::kRobotStatus, channels::kStop, channels::kTeleopCommand, channels::kGridTile,
                              channels::kNavigationStatus, channels::kHypotheses}) {
    loop_.lcm().publish(channel, bytes, sizeof(bytes));
  }
  pose_t pose{};
  pose.x = std::numeric_limits<double>::quiet_NaN();
  loop_.lcm().publish(channels::kPose, &pose);
  path_t path{};
  path.count = 1;
  path.x = {std::numeric_limits<float>::infinity()};
  path.y = {0.0F};
  loop_.lcm().publish(channels::kPath, &path);
  sonar_t sonar{};
  sonar.session = 7;
  loop_.lcm().publish(channels::kSonar, &sonar);
  hypotheses_t hypotheses{};
  hypotheses.count = 1;
  hypotheses.x = hypotheses.y = hypotheses.theta = hypotheses.sigma = {0.0F};
  hypotheses.weight = {-1.0F};
  loop_.lcm().publish(channels::kHypotheses, &hypotheses);
  odometry_t odometry{};
  odometry.utime = 5;
  loop_.lcm().publish(channels::kOdometry, &odometry);
  run(0.1);
  EXPECT_EQ(loop_.node().health().dropped_inputs - before, 10 + 5);
  run(1.0);
  EXPECT_GT(loop_.command_message().linear_x, 0.2);
}

TEST_F(ControllerNodeTest, StandsStillWhenThePathIsTakenAway) {
  loop_.start({.goal = {5.0, 1.5}, .replan_every = 0.0});
  run(2.0);
  ASSERT_GT(loop_.command_message().linear_x, 0.2);
  path_t path{};
  path.utime = loop_.command_message().utime;
  path.goal_id = 1;
  path.sequence = 1000;
  loop_.lcm().publish(channels::kPath, &path);
  run(1.5);
  expect_standing("no path");
}

// ----------------------------------------------------------------------------------------------------------- zones

/// A person's hand on the stick, at one tick of many.
void steer_ahead(ClosedLoop& loop, int tick) {
  teleop_command_t message{};
  message.utime = loop.utime();
  message.session = 5;
  message.sequence = tick;
  message.linear = 0.4;
  loop.lcm().publish(channels::kTeleopCommand, &message);
  loop.tick();
}

TEST(KeepOutZones, HoldAPersonWhoSteersAlsoWhenTheLocalizerFallsSilent) {
  for (const bool is_silent : {false, true}) {
    ControllerConfig config = read_controller_config(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
    config.building.zones = {{"stairs", ZoneKind::kKeepOut, {{3.0, 0.4}, {4.0, 0.4}, {4.0, 2.4}, {3.0, 2.4}}}};
    KinematicWorld world(config.robot, kHall);
    world.place_robot({1.0, 1.5, 0.0});
    ClosedLoop loop(world, config);
    for (int i = 0; i < 600; ++i) {
      loop.drops_pose = is_silent && i > 50;
      steer_ahead(loop, i);
    }
    EXPECT_LT(world.truth().x, 3.0 - 0.2) << is_silent;
    EXPECT_GT(world.truth().x, 2.0) << is_silent;
  }
}

TEST(KeepOutZones, HoldFromTheMomentWhenTheyAreDrawn) {
  const ControllerConfig config = read_controller_config(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
  KinematicWorld world(config.robot, kHall);
  world.place_robot({1.0, 1.5, 0.0});
  ClosedLoop loop(world, config);
  for (int i = 0; i < 600; ++i) {
    if (i == 100) {
      ASSERT_GT(world.twist().linear, 0.2);
      loop.node().set_zones({{"stairs", ZoneKind::kKeepOut, {{3.0, 0.4}, {4.0, 0.4}, {4.0, 2.4}, {3.0, 2.4}}}});
    }
    steer_ahead(loop, i);
  }
  EXPECT_LT(world.truth().x, 3.0 - 0.2);
  EXPECT_GT(world.truth().x, 2.0);
}

TEST(KeepOutZones, HoldInTheirHoursAlone) {
  for (const bool begins : {true, false}) {
    ControllerConfig config = read_controller_config(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
    KinematicWorld world(config.robot, kHall);
    world.place_robot({1.0, 1.5, 0.0});
    config.local_clock = [start = std::optional<std::int64_t>()](std::int64_t utime) mutable {
      start = start.value_or(utime);
      return LocalTime{0, 0, 10 * 3600 + static_cast<int>((utime - *start) / 1'000'000)};
    };
    constexpr int kSoon = 10 * 3600 + 3;
    config.building.zones = {{.name = "yard",
                              .polygon = {{3.0, 0.4}, {4.0, 0.4}, {4.0, 2.4}, {3.0, 2.4}},
                              .hours = begins ? Hours{kSoon, 12 * 3600} : Hours{8 * 3600, kSoon}}};
    ClosedLoop loop(world, config);
    for (int i = 0; i < 600; ++i) {
      steer_ahead(loop, i);
    }
    EXPECT_EQ(world.truth().x < 3.0 - 0.2, begins) << world.truth().x;
  }
}

// ------------------------------------------------------------------------------------------------ senses that are dead

// 18 x 2.4 m outside, 1.8 m wide inside
const std::vector<std::string> kLongCorridor{"############################################################",
                                             "#..........................................................#",
                                             "#..........................................................#",
                                             "#..........................................................#",
                                             "#..........................................................#",
                                             "#..........................................................#",
                                             "#..........................................................#",
                                             "############################################################"};

class DeadSonars : public ::testing::Test {
 protected:
  DeadSonars() {
    world_.place_robot({1.0, 1.2, 0.0});
    loop_.start({.goal = {16.0, 1.2}});
    run(4.0);
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(50.0 * seconds); ++i) {
      loop_.tick();
    }
  }
  /// Drives on until it stands, at most 20 s, and returns how far [m] it came at more than 0.16 m/s and in all.
  std::pair<double, double> drive_on() {
    const double start = loop_.driven();
    double fast = 0.0;
    for (int i = 0; i < 1000; ++i) {
      loop_.tick();
      fast = world_.twist().linear > 0.16 ? loop_.driven() - start : fast;
    }
    return {fast, loop_.driven() - start};
  }

  static ControllerConfig config() {
    ControllerConfig config = read_controller_config(std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml");
    config.building.search = SearchManner::kWander;
    return config;
  }
  ControllerConfig config_ = config();
  KinematicWorld world_{config_.robot, kLongCorridor};
  ClosedLoop loop_{world_, config_};
};

TEST_F(DeadSonars, OfAllDiscsMakeItSlowAndThenStandWithOneSentence) {
  ASSERT_GT(world_.twist().linear, 0.4);
  ASSERT_FALSE(loop_.node().health().degraded);
  for (std::size_t disc = 0; disc < 16; ++disc) {
    loop_.deaf.insert(disc);
  }
  const auto [fast, way] = drive_on();
  EXPECT_LT(fast, 1.0);
  EXPECT_LT(way, 1.8);
  EXPECT_DOUBLE_EQ(loop_.command_message().linear_x, 0.0);
  EXPECT_EQ(loop_.status().state, control_status_t::STATE_STOPPED);
  EXPECT_NE(loop_.status().reason.find("heard nothing where walls must be: it stands"), std::string::npos)
      << loop_.status().reason;
  EXPECT_TRUE(loop_.node().health().degraded);
  EXPECT_EQ(loop_.node().health().reason, loop_.status().reason);
}

TEST_F(DeadSonars, OfTheFrontMakeItStand) {
  for (std::size_t disc = 0; disc < 8; ++disc) {
    loop_.deaf.insert(disc);
  }
  EXPECT_LT(drive_on().second, 1.8);
  EXPECT_NE(loop_.status().reason.find("heard nothing where walls must be"), std::string::npos);
}

TEST_F(DeadSonars, ThatSayTheSameRangeMakeItStand) {
  loop_.stuck_at = 3.0;
  EXPECT_LT(drive_on().second, 1.8);
  EXPECT_NE(loop_.status().reason.find("it stands"), std::string::npos) << loop_.status().reason;
}

TEST_F(DeadSonars, ThatSayTheSameRangeMakeItStandWhereThePoseIsNotKnown) {
  loop_.is_tracking = false;
  loop_.localize();
  run(2.0);
  loop_.stuck_at = 3.0;
  EXPECT_LT(drive_on().second, 2.5);
  EXPECT_NE(loop_.status().reason.find("measured the same while the robot moved"), std::string::npos)
      << loop_.status().reason;
}

TEST_F(DeadSonars, OfOneDiscLetItDriveSlowlyToItsGoal) {
  loop_.deaf = {0};
  run(10.0);
  EXPECT_TRUE(loop_.node().health().degraded);
  EXPECT_NEAR(loop_.command_message().linear_x, 0.15, 0.01);
}

TEST_F(DeadSonars, ThatHearAgainLetItDriveOn) {
  for (std::size_t disc = 0; disc < 16; ++disc) {
    loop_.deaf.insert(disc);
  }
  drive_on();
  ASSERT_EQ(loop_.status().state, control_status_t::STATE_STOPPED);
  loop_.deaf.clear();
  run(6.0);
  EXPECT_FALSE(loop_.node().health().degraded) << loop_.node().health().reason;
  EXPECT_GT(world_.twist().linear, 0.3);
}

}  // namespace
}  // namespace luminav::testing
