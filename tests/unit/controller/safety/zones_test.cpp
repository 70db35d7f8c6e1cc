#include "services/controller/safety/zones.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/controller/controller.hpp"
#include "services/controller/following/speed_law.hpp"
#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

const Polygon kStairs = {{2.0, -1.0}, {4.0, -1.0}, {4.0, 1.0}, {2.0, 1.0}};

ControllerConfig with_zone(ZoneKind kind) {
  ControllerConfig config = ControllerConfig::for_robot(testing::test_robot());
  config.building.zones = {{"stairs", kind, kStairs, 0.15}};
  return config;
}

struct Drive {
  Pose2 end;
  double max_speed_inside = 0.0;  // [m/s] of the middle
  bool has_touched = false;       // a corner of the outline was inside
  std::string reason{};           // the last that was given
};

/// A person pushes a robot of which only the zone is known, for 20 s.
Drive push(const ControllerConfig& config, const Pose2& start, const DriveTwist& wish, bool knows_its_pose = true,
           const std::vector<PoseAlternative>& alternatives = {}) {
  Controller controller(config);
  ControlInput input;
  input.task = knows_its_pose ? ControlTask::kTeleop : ControlTask::kWander;
  input.teleoperation = wish;
  input.alternatives = alternatives;
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  Drive drive{.end = start};
  for (int i = 1; i <= 400; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    input.odom_from_robot = drive.end;
    if (knows_its_pose) {
      input.world_from_robot = drive.end;
    }
    const ControlOutput output = controller.step(input);
    drive.reason = output.reason.empty() ? drive.reason : output.reason;
    drive.end = drive.end * drive_arc(output.twist, 0.05);
    if (contains(kStairs, drive.end.position())) {
      drive.max_speed_inside = std::max(drive.max_speed_inside, std::abs(output.twist.linear));
    }
    for (const Eigen::Vector2d& corner : config.robot.footprint) {
      drive.has_touched = drive.has_touched || contains(kStairs, drive.end * corner);
    }
  }
  return drive;
}

TEST(Zones, StopAPersonWhoSteersIntoAKeepOutZone) {
  for (const double theta : {0.0, 0.3, -0.4}) {
    const Drive drive = push(with_zone(ZoneKind::kKeepOut), {0.0, 0.0, theta}, {0.5, 0.0});
    EXPECT_FALSE(drive.has_touched) << "theta " << theta;
  }
  const Drive head_on = push(with_zone(ZoneKind::kKeepOut), {}, {0.5, 0.0});
  EXPECT_NE(head_on.reason.find("keep-out zone"), std::string::npos) << head_on.reason;
  EXPECT_FALSE(push(with_zone(ZoneKind::kKeepOut), {0.0, 0.0, kPi}, {-0.5, 0.0}).has_touched) << "backwards";
}

TEST(Zones, LetARobotOutThatIsInsideAndNotInAgain) {
  const Drive out = push(with_zone(ZoneKind::kKeepOut), {3.0, 0.0, kPi}, {0.4, 0.0});
  EXPECT_LT(out.end.x, 0.0);
  EXPECT_GT(out.max_speed_inside, 0.2);
}

TEST(Zones, LetARobotOutAtAnyAngleWhateverOfItIsInside) {
  for (const double theta : {0.0, 0.3, 0.8, 1.3, 1.8, 2.6}) {
    for (const double speed : {0.3, -0.3}) {
      // its middle is just outside, and it moves away from the zone, more or less
      const Pose2 start{2.0 - 0.05, 0.0, wrap_angle(theta + 0.5 * kPi + (speed < 0.0 ? kPi : 0.0))};
      const Drive out = push(with_zone(ZoneKind::kKeepOut), start, {speed, 0.0});
      EXPECT_LT(out.end.x, theta == 0.0 ? 1.96 : 1.4) << theta << " " << speed << ": " << out.reason;
    }
  }
}

TEST(Zones, LetNobodyPushARobotDeeperWhoseCornerIsInside) {
  const auto depth_at = [](const Pose2& robot) {
    Polygon outline;
    for (const Eigen::Vector2d& corner : testing::test_robot().footprint) {
      outline.push_back(robot * corner);
    }
    return overlap_depth(outline, kStairs, 0.02);
  };
  const Pose2 start{2.0 - 0.22, 0.0, 0.2};
  ASSERT_GT(depth_at(start), 0.0);
  for (const DriveTwist wish : {DriveTwist{0.3, 0.0}, {0.0, 0.5}, {0.0, -0.5}, {0.2, 0.3}}) {
    const Drive drive = push(with_zone(ZoneKind::kKeepOut), start, wish);
    EXPECT_LT(depth_at(drive.end), depth_at(start) + 0.01) << wish.linear << " " << wish.angular;
  }
}

TEST(Zones, CountForEachPoseThatIsPossibleWhileItSearches) {
  ControllerConfig config = with_zone(ZoneKind::kKeepOut);
  config.building.search = SearchManner::kWander;
  const std::vector<PoseAlternative> alternatives = {{Pose2{}, 0.5}, {Pose2{30.0, 0.0, 0.0}, 0.5}};
  EXPECT_FALSE(push(config, {0.8, 0.0, 0.0}, {}, false, alternatives).has_touched);
}

TEST(Zones, HoldAPersonToEachPoseThatIsPossible) {
  Controller controller(with_zone(ZoneKind::kKeepOut));
  ControlInput input;
  input.task = ControlTask::kTeleop;
  input.teleoperation = {0.4, 0.0};
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  input.alternatives = {{Pose2{30.0, 0.0, 0.0}, 0.6}, {Pose2{}, 0.4}};
  bool has_touched = false;
  for (int i = 1; i <= 200; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    input.odom_from_robot = input.odom_from_robot * drive_arc(controller.step(input).twist, 0.05);
    for (const Eigen::Vector2d& corner : testing::test_robot().footprint) {
      has_touched = has_touched || contains(kStairs, input.odom_from_robot * corner);
    }
  }
  EXPECT_FALSE(has_touched);
  EXPECT_GT(input.odom_from_robot.x, 1.0) << "and no more than that";
}

// Two possible poses, at one of which its nose is inside and at the other its back: no straight piece is allowed, and a
// search begins with a turn.
TEST(Zones, LetASearchingRobotTurnWhereNoPoseLetsItDrive) {
  ControllerConfig config = with_zone(ZoneKind::kKeepOut);
  config.building.search = SearchManner::kWander;
  Controller controller(config);
  ControlInput input;
  input.task = ControlTask::kWander;
  input.alternatives = {{Pose2{}, 0.5}, {Pose2{-2.22, 0.0, 0.0}, 0.5}};
  input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
  input.odom_from_robot = {4.11, 0.0, 0.0};
  double farthest_turned = 0.0;
  for (int i = 1; i <= 600; ++i) {
    input.now = 1'000'000 + 50'000 * i;
    input.odom_from_robot = input.odom_from_robot * drive_arc(controller.step(input).twist, 0.05);
    farthest_turned = std::max(farthest_turned, std::abs(wrap_angle(input.odom_from_robot.theta)));
    for (const PoseAlternative& alternative : input.alternatives) {
      ASSERT_FALSE(contains(kStairs, (alternative.world_from_odom * input.odom_from_robot).position())) << i;
    }
  }
  EXPECT_GT(farthest_turned, radians(60.0));
}

TEST(Zones, LeaveALineFreeThatKeepsItsDistance) {
  const Zones zones({{"stairs", ZoneKind::kKeepOut, kStairs, 0.2}}, testing::test_robot().footprint);
  EXPECT_FALSE(zones.is_line_free({1.0, -2.0}, {5.0, 1.0}, 0.25)) << "through it";
  EXPECT_FALSE(zones.is_line_free({1.0, 1.2}, {5.0, 1.2}, 0.25)) << "along it, too near";
  EXPECT_TRUE(zones.is_line_free({1.0, 1.3}, {5.0, 1.3}, 0.25));
  EXPECT_TRUE(zones.is_line_free({3.0, 0.0}, {5.0, 1.3}, 0.25)) << "who is inside may leave";
}

TEST(Zones, LetNoRobotDriveAgainstAOneWayZoneButByHand) {
  ControllerConfig config = with_zone(ZoneKind::kOneWay);
  config.building.zones[0].direction = 0.5 * kPi;
  const auto drives = [&](double theta, ControlTask task) {
    Controller controller(config);
    FollowedPath path;
    const Pose2 robot{3.0, 0.0, theta};
    for (double way = 0.0; way < 3.0; way += 0.2) {
      path.points.push_back(robot * Eigen::Vector2d(way, 0.0));
    }
    controller.set_path(path);
    ControlInput input;
    input.task = task;
    input.world_from_robot = robot;
    input.teleoperation = {0.3, 0.0};
    input.ages = {0.05, 0.05, 0.2, 0.2, false, false};
    ControlOutput output;
    for (int i = 1; i <= 10; ++i) {
      input.now = 1'000'000 + 50'000 * i;
      output = controller.step(input);
    }
    return output.twist.linear > 0.01;
  };
  EXPECT_TRUE(drives(0.5 * kPi, ControlTask::kFollow)) << "with it";
  EXPECT_TRUE(drives(0.0, ControlTask::kFollow)) << "straight across";
  EXPECT_FALSE(drives(-0.5 * kPi, ControlTask::kFollow));
  EXPECT_FALSE(drives(-0.7, ControlTask::kFollow));
  EXPECT_TRUE(drives(-0.5 * kPi, ControlTask::kTeleop));
}

TEST(Zones, GiveARobotSixCentimetresAgainstAOneWayZoneToSteerBy) {
  Zones zones({{"lane", ZoneKind::kOneWay, kStairs, 0.2, 0.5 * kPi}}, testing::test_robot().footprint);
  const auto room = [&](double y, double theta) {
    zones.note_progress({3.0, y});
    const auto found = zones.room_against({3.0, y, theta}, 0.3);
    return found ? found->distance : std::numeric_limits<double>::infinity();
  };
  EXPECT_NEAR(room(0.0, -0.4), 0.06 / std::sin(0.4), 1e-9) << "a little back, to a door";
  EXPECT_EQ(room(0.0, -0.6), 0.0) << "too steep";
  EXPECT_NEAR(room(-0.04, -0.4), 0.02 / std::sin(0.4), 1e-9);
  EXPECT_EQ(room(-0.08, -0.4), 0.0) << "and no more";
  EXPECT_TRUE(std::isinf(room(-0.08, 0.0))) << "across it may";
  EXPECT_EQ(zones.room_against({3.0, -0.08, kPi - 0.4}, -0.3)->distance, 0.0) << "backwards as forwards";
  EXPECT_TRUE(std::isinf(room(0.5, 0.4)));
  EXPECT_EQ(room(0.42, -0.4), 0.0) << "counted from as far as it came";
  zones.note_progress({0.0, 0.0});
  EXPECT_GT(room(0.0, -0.4), 0.1) << "it left and came in again";
  zones.note_progress({0.0, 0.0});
  EXPECT_FALSE(zones.room_against({0.0, 0.0, -0.5 * kPi}, 0.3)) << "outside";
  zones.note_progress({3.0, 1.5});
  EXPECT_NEAR(zones.room_against({3.0, 1.52, -0.5 * kPi}, 0.3)->distance, 0.58, 0.05) << "before it";
}

TEST(Zones, SayWhereTheOneWayZoneLeadsInWhichTheRobotIs) {
  const Zones zones({{"stairs", ZoneKind::kKeepOut, kStairs}, {"lane", ZoneKind::kOneWay, kStairs, 0.2, 0.5 * kPi}},
                    testing::test_robot().footprint);
  EXPECT_EQ(zones.lane_at({3.0, 0.0}), 0.5 * kPi);
  EXPECT_FALSE(zones.lane_at({0.0, 0.0}));
}

TEST(Zones, LookRoundInsteadOfWanderingWhereItIsQuiet) {
  ControllerConfig config = with_zone(ZoneKind::kQuiet);
  config.building.search = SearchManner::kWander;
  const auto way = [&](double inside) {
    return push(config, {3.0, 0.0, 0.0}, {}, false, {{Pose2{}, inside}, {Pose2{30.0, 0.0, 0.0}, 1.0 - inside}}).end;
  };
  EXPECT_NEAR(way(0.6).x, 3.0, 0.01);
  EXPECT_GT(std::hypot(way(0.4).x - 3.0, way(0.4).y), 0.3) << "it is rather elsewhere";
}

TEST(Zones, SlowARobotDownBeforeASlowZoneAndInside) {
  const Drive drive = push(with_zone(ZoneKind::kSlow), {0.0, 0.0, 0.0}, {0.5, 0.0});
  EXPECT_LE(drive.max_speed_inside, 0.15 + 1e-6);
  EXPECT_GT(drive.max_speed_inside, 0.10);
  EXPECT_TRUE(drive.has_touched);
}

TEST(Zones, NameTheZoneInWhichARobotIs) {
  const Zones zones({{"stairs", ZoneKind::kKeepOut, kStairs, 0.2}}, testing::test_robot().footprint);
  EXPECT_EQ(zones.keep_out_at({3.0, 0.0, 1.0}), "stairs");
  EXPECT_EQ(zones.keep_out_at({1.0, 0.0, 1.0}), "");
}

}  // namespace
}  // namespace luminav
