#include "services/planner/situation_input.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;  // [us]

pose_t pose(std::int64_t utime, std::int8_t state = pose_t::STATE_TRACKING) {
  pose_t message{};
  message.utime = utime;
  message.state = state;
  message.x = 4.0;
  message.reason = "it was carried";
  return message;
}

robot_status_t status(std::int64_t utime) {
  robot_status_t message{};
  message.utime = utime;
  message.connected = message.motors_enabled = 1;
  return message;
}

control_status_t following(std::int64_t utime, std::int32_t sequence = 0) {
  control_status_t message{};
  message.utime = utime;
  message.sequence = sequence;
  message.state = control_status_t::STATE_FOLLOWING;
  return message;
}

TEST(SituationInput, KnowsThePlaceWhileThePoseIsFresh) {
  SituationInput input;
  EXPECT_FALSE(input.at(kNow).tracking);
  EXPECT_TRUE(input.take(pose(kNow)).is_tick);
  EXPECT_TRUE(input.at(kNow + 1'000'000).tracking);
  EXPECT_EQ(input.at(kNow).world_from_robot.x, 4.0);
  EXPECT_FALSE(input.at(kNow + 1'000'001).tracking);
  EXPECT_FALSE(input.at(kNow + 1'000'001).localization.empty());
  input.take(pose(kNow + 100'000, pose_t::STATE_LOST));
  EXPECT_FALSE(input.at(kNow + 100'000).tracking);
  EXPECT_EQ(input.at(kNow + 100'000).localization, "it was carried");
}

TEST(SituationInput, TakesACorrectedPoseWithoutATickAndRefusesAnOldOne) {
  SituationInput input;
  input.take(pose(kNow));
  pose_t corrected = pose(kNow);
  corrected.x = 4.1;
  const SituationInput::Verdict verdict = input.take(corrected);
  EXPECT_FALSE(verdict.is_tick || verdict.is_refused);
  EXPECT_EQ(input.at(kNow).world_from_robot.x, 4.1);
  EXPECT_TRUE(input.take(pose(kNow - 100'000)).is_refused);
  EXPECT_EQ(input.at(kNow).world_from_robot.x, 4.1);
}

TEST(SituationInput, TicksByRobotStatusWhereNoPoseComes) {
  SituationInput input;
  EXPECT_TRUE(input.take(status(kNow)).is_tick);
  input.take(pose(kNow + 20'000));
  EXPECT_FALSE(input.take(status(kNow + 40'000)).is_tick);
  EXPECT_TRUE(input.take(status(kNow + 180'000)).is_tick);
  EXPECT_TRUE(input.take(status(0)).is_refused);
}

TEST(SituationInput, SaysWhatKeepsTheRobotFromMoving) {
  SituationInput input;
  input.take(status(kNow));
  EXPECT_TRUE(input.at(kNow).can_move);
  control_status_t stopped = following(kNow);
  stopped.stop_engaged = 1;
  input.take(stopped, kNow);
  EXPECT_EQ(input.at(kNow).cannot_move, "a stop is engaged");
  EXPECT_TRUE(input.at(kNow + 2'000'001).can_move) << "a controller that fell silent says nothing";
  robot_status_t off = status(kNow + 20'000);
  off.motors_enabled = 0;
  input.take(off);
  EXPECT_FALSE(input.at(kNow).can_move);
  EXPECT_EQ(input.at(kNow).cannot_move, "the motors are off");
}

TEST(SituationInput, TellsATouchOnThePathOnce) {
  SituationInput input;
  robot_status_t blocked = status(kNow);
  blocked.stall_left = 1;
  input.take(blocked);
  EXPECT_FALSE(input.at(kNow).has_touched) << "it stood";
  input.take(status(kNow + 20'000));
  input.take(following(kNow + 20'000), kNow);
  blocked.utime = kNow + 40'000;
  input.take(blocked);
  input.take(status(kNow + 60'000));
  EXPECT_TRUE(input.at(kNow).has_touched) << "over by now";
  input.end_tick();
  EXPECT_FALSE(input.at(kNow).has_touched);
}

TEST(SituationInput, TakesTheSecondOfTwoWordsOfTheControllerWithOneStamp) {
  SituationInput input;
  input.take(following(kNow, 1), kNow);
  control_status_t second = following(kNow, 2);
  second.state = control_status_t::STATE_AT_GOAL;
  input.take(second, kNow);
  ASSERT_TRUE(input.at(kNow).control);
  EXPECT_TRUE(input.at(kNow).control->at_goal);
  control_status_t broken = following(kNow + 100'000, 3);
  broken.seconds_without_progress = std::numeric_limits<float>::quiet_NaN();
  input.take(broken, kNow + 100'000);
  EXPECT_TRUE(input.at(kNow).control->at_goal);
}

TEST(SituationInput, WaitsForAControllerFromTheFirstTickOn) {
  SituationInput input;
  input.take(following(kNow), 0);  // before anything of the robot came
  input.begin_tick(kNow);
  EXPECT_TRUE(input.at(kNow + 2'000'000).control);
  EXPECT_FALSE(input.at(kNow + 2'000'001).control);
}

}  // namespace
}  // namespace luminav
