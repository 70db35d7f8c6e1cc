#include "services/controller/safety/zones.hpp"

#include <gtest/gtest.h>

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

TEST(Zones, CountForEachPoseThatIsPossibleWhileItSearches) {
  ControllerConfig config = with_zone(ZoneKind::kKeepOut);
  config.building.search = SearchManner::kWander;
  const std::vector<PoseAlternative> alternatives = {{Pose2{}, 0.5}, {Pose2{30.0, 0.0, 0.0}, 0.5}};
  EXPECT_FALSE(push(config, {0.8, 0.0, 0.0}, {}, false, alternatives).has_touched);
}

TEST(Zones, SlowARobotDownBeforeASlowZoneAndInside) {
  const Drive drive = push(with_zone(ZoneKind::kSlow), {0.0, 0.0, 0.0}, {0.5, 0.0});
  EXPECT_LE(drive.max_speed_inside, 0.15 + 1e-6);
  EXPECT_GT(drive.max_speed_inside, 0.10);
  EXPECT_TRUE(drive.has_touched);
}

TEST(Zones, NameTheZoneInWhichARobotIs) {
  const Zones zones({{"stairs", ZoneKind::kKeepOut, kStairs, 0.2}});
  EXPECT_EQ(zones.keep_out_at({3.0, 0.0, 1.0}), "stairs");
  EXPECT_EQ(zones.keep_out_at({1.0, 0.0, 1.0}), "");
}

}  // namespace
}  // namespace luminav
