#include "tests/evaluation/judge/zone_judge.hpp"

#include <gtest/gtest.h>

#include "drivers/simulator/geometry/shapes.hpp"
#include "services/common/process/channels.hpp"
#include "tests/evaluation/judge/map_score.hpp"

namespace luminav {
namespace {

/// A hall of 10 x 4 m in which a robot of 0.4 x 0.4 m drives; the zone of its middle is 2 x 4 m.
struct Hall {
  explicit Hall(ZoneKind kind, const Hours& hours = {})
      : judge(lcm, {{"zone", kind, rectangle({5.0, 2.0, 0.0}, 2.0, 4.0), 0.2, 0.0, hours}}, universal_time, world()) {}

  static WorldTruth world() {
    WorldTruth world;
    world.robot.footprint = rectangle({}, 0.4, 0.4);
    world.walls.geometry = GridGeometry{0.1, {0.0, 0.0}, 100, 40};
    world.walls.cells.assign(world.walls.geometry.size(), Prior::kFree);
    return world;
  }
  void be_at(double x, double speed = 0.1, bool is_tracking = true) {
    utime += 100'000;
    pose_t pose{};
    pose.utime = utime;
    pose.state = is_tracking ? pose_t::STATE_TRACKING : pose_t::STATE_LOST;
    lcm.publish(channels::kPose, &pose);
    sim_truth_t truth{};
    truth.utime = utime;
    truth.x = x;
    truth.y = 2.0;
    truth.linear = speed;
    lcm.publish(channels::kSimTruth, &truth);
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  std::int64_t utime = 1'000'000;
  lcm::LCM lcm{"memq://"};
  ZoneJudge judge;
};

TEST(ZoneJudge, MeasuresHowDeepTheOutlineIsInAKeepOutZone) {
  Hall hall(ZoneKind::kKeepOut);
  hall.be_at(3.7);
  EXPECT_EQ(hall.judge.failure({}), "");
  hall.be_at(3.83);
  EXPECT_NEAR(hall.judge.result()->keep_out_m, 0.03, 1e-6);
  EXPECT_NE(hall.judge.failure({}), "");
}

TEST(ZoneJudge, LetsARobotOutThatFoundItselfInsideButNotInAgain) {
  Hall hall(ZoneKind::kKeepOut);
  hall.be_at(5.0, 0.1, false);
  for (double x = 5.0; x < 6.4; x += 0.1) {
    hall.be_at(x);
  }
  EXPECT_EQ(hall.judge.failure({}), "");
  EXPECT_NEAR(hall.judge.result()->leaving_s, 1.2, 0.15);
  hall.be_at(6.0);
  EXPECT_NE(hall.judge.failure({}), "");
}

TEST(ZoneJudge, SeesWhoIsTooFastOrDrivesAgainstALane) {
  Hall slow(ZoneKind::kSlow);
  for (int i = 0; i < 20; ++i) {
    slow.be_at(5.0, 0.22);
  }
  EXPECT_EQ(slow.judge.failure({}), "");
  slow.be_at(5.0, -0.3);
  EXPECT_NEAR(slow.judge.result()->over_speed_m_s, 0.1, 1e-6);
  EXPECT_NE(slow.judge.failure({}), "");
  Hall lane(ZoneKind::kOneWay);
  for (const double x : {4.5, 5.0, 5.5, 5.45}) {
    lane.be_at(x);
  }
  EXPECT_EQ(lane.judge.failure({}), "");
  lane.be_at(5.2);
  EXPECT_NEAR(lane.judge.result()->against_m, 0.3, 1e-6);
  EXPECT_NE(lane.judge.failure({}), "");
}

TEST(ZoneJudge, AsksNothingOutsideAZonesHoursAndTimeToLeaveWhenTheyBegin) {
  constexpr int kSoon = 3;  // [s] after midnight
  Hall hall(ZoneKind::kKeepOut, {kSoon, 12 * 3600});
  while (hall.utime < 3'500'000) {
    hall.be_at(5.0);
  }
  EXPECT_EQ(hall.judge.failure({}), "");
  EXPECT_NEAR(hall.judge.result()->leaving_s, 0.6, 0.15);
  hall.be_at(3.0);
  hall.be_at(5.0);
  EXPECT_NE(hall.judge.failure({}), "") << "it has left, and is in again";
}

TEST(ZoneJudge, ComparesWaysWithTheShortestAllowedOne) {
  Hall lane(ZoneKind::kOneWay);
  EXPECT_NEAR(lane.judge.shortest({1.0, 2.0}, {9.0, 2.0}), 8.0, 0.1);
  EXPECT_LT(lane.judge.shortest({9.0, 2.0}, {1.0, 2.0}), 0.0);
  lane.judge.compare(10.0, 8.0);
  EXPECT_EQ(lane.judge.failure({}), "");
  lane.judge.compare(12.0, 8.0);
  EXPECT_NE(lane.judge.failure({}), "");
}

TEST(ZoneJudge, WantsARefusalToNameAZone) {
  const Hall hall(ZoneKind::kKeepOut);
  GoalResult goal;
  goal.refused = goal.expect_refused = true;
  goal.cause = "no way leads there";
  EXPECT_NE(hall.judge.failure({goal}), "");
  goal.cause = "no way leads there; in the way: keep-out zone zone";
  EXPECT_EQ(hall.judge.failure({goal}), "");
}

}  // namespace
}  // namespace luminav
