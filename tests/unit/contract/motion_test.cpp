#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/contract/base_exercise.hpp"
#include "drivers/contract/command_ledger.hpp"
#include "drivers/contract/motion_watch.hpp"
#include "drivers/contract/request_watch.hpp"

namespace luminav {
namespace {

using Verdict = Clause::Verdict;

constexpr std::int64_t kStart = 1'000'000'000;  // [us]
constexpr std::int64_t kTick = 20'000;          // [us]

velocity_command_t command_at(std::int64_t utime, std::int32_t sequence, double linear = 0.2) {
  velocity_command_t command{};
  command.utime = utime;
  command.robot = "p3dx";
  command.session = kStart;
  command.sequence = sequence;
  command.linear_x = linear;
  return command;
}

robot_status_t status_at(std::int64_t utime) {
  robot_status_t status{};
  status.utime = utime;
  status.robot = "p3dx";
  status.connected = status.motors_enabled = 1;
  status.maximum_linear = 0.5;
  status.maximum_angular = 1.0;
  status.deceleration = 1.0;
  return status;
}

TEST(CommandLedger, TakesFreshCommandsOfGrowingSequence) {
  CommandLedger ledger;
  EXPECT_EQ(ledger.hear(command_at(kStart, 1), "p3dx", kStart), "");
  EXPECT_EQ(ledger.hear(command_at(kStart, 1), "p3dx", kStart), "out of sequence");
  EXPECT_EQ(ledger.hear(command_at(kStart - 400'000, 2), "p3dx", kStart), "too old");
  EXPECT_EQ(ledger.hear(command_at(kStart + 400'000, 2), "p3dx", kStart), "from the future");
  velocity_command_t sideways = command_at(kStart, 2);
  sideways.linear_y = 0.1;
  EXPECT_EQ(ledger.hear(sideways, "p3dx", kStart), "sideways");
  EXPECT_EQ(ledger.refusable(), 4);
  EXPECT_EQ(ledger.hear(command_at(kStart, 2), "other", kStart), "for another robot");
  EXPECT_EQ(ledger.refusable(), 4) << "nobody has to count what is meant for another";
  EXPECT_EQ(ledger.last().utime, kStart);
}

TEST(CommandLedger, KnowsSinceWhenTheSameIsCommanded) {
  CommandLedger ledger;
  for (int i = 0; i < 5; ++i) {
    ledger.hear(command_at(kStart + i * kTick, i + 1), "p3dx", kStart + i * kTick);
  }
  EXPECT_EQ(ledger.steady_since(), kStart);
  ledger.hear(command_at(kStart + 5 * kTick, 6, 0.1), "p3dx", kStart + 5 * kTick);
  EXPECT_EQ(ledger.steady_since(), kStart + 5 * kTick);
}

/// A base that is commanded 0.2 m/s for two seconds and then nothing, and stands so long [s] after the last command.
Clause stands_after(double seconds) {
  MotionWatch watch{RobotDescription{}};
  for (int i = 0; i < 300; ++i) {
    const std::int64_t now = kStart + i * kTick;
    watch.hear(status_at(now));
    if (i < 100) {
      watch.hear(command_at(now, i + 1));
    }
    odometry_t odometry{};
    odometry.utime = now;
    odometry.linear = i < 100 + static_cast<int>(seconds / 0.02) ? 0.2 : 0.0;
    watch.hear(odometry);
  }
  return watch.clauses()[1];
}

TEST(MotionWatch, LetsABaseBrakeAfterTheTimeoutAndNotDriveOn) {
  EXPECT_EQ(stands_after(0.5).verdict(), Verdict::kHolds) << "0.3 s and the braking from 0.2 m/s";
  EXPECT_EQ(stands_after(1.2).verdict(), Verdict::kBroken);
}

TEST(MotionWatch, FindsABaseThatMovesBeforeAnybodyCommands) {
  MotionWatch watch{RobotDescription{}};
  for (int i = 0; i < 200; ++i) {
    watch.hear(status_at(kStart + i * kTick));
    odometry_t odometry{};
    odometry.utime = kStart + i * kTick;
    odometry.angular = 0.2;
    watch.hear(odometry);
  }
  EXPECT_EQ(watch.clauses()[1].verdict(), Verdict::kBroken);
}

TEST(MotionWatch, ForgivesABaseThatIsPushedWithItsMotorsOff) {
  MotionWatch watch{RobotDescription{}};
  for (int i = 0; i < 200; ++i) {
    robot_status_t status = status_at(kStart + i * kTick);
    status.motors_enabled = 0;
    watch.hear(status);
    odometry_t odometry{};
    odometry.utime = kStart + i * kTick;
    odometry.linear = 0.2;
    watch.hear(odometry);
  }
  EXPECT_EQ(watch.clauses()[1].verdict(), Verdict::kNotSeen);
}

/// A base that may turn by 1 rad/s, and does for two seconds, but for so many of the ODOMETRYs that say 1.2.
Clause turns_too_fast(int many) {
  MotionWatch watch{RobotDescription{}};
  for (int i = 0; i < 100; ++i) {
    watch.hear(status_at(kStart + i * kTick));
    odometry_t odometry{};
    odometry.utime = kStart + i * kTick;
    odometry.angular = i < many ? 1.2 : 1.0;
    watch.hear(odometry);
  }
  return watch.clauses()[3];
}

TEST(MotionWatch, HoldsABaseToItsLimitsOverHalfASecond) {
  EXPECT_EQ(turns_too_fast(5).verdict(), Verdict::kHolds) << "stamps jitter";
  EXPECT_EQ(turns_too_fast(50).verdict(), Verdict::kBroken);
}

stop_t stop_of(std::int64_t id, bool engaged) {
  stop_t stop{};
  stop.id = id;
  stop.engaged = engaged ? 1 : 0;
  return stop;
}

TEST(RequestWatch, FindsAStopThatEndsByItself) {
  RequestWatch watch;
  watch.hear(status_at(kStart));
  watch.hear(stop_of(5, true));
  for (int i = 1; i < 100; ++i) {
    robot_status_t status = status_at(kStart + i * kTick);
    status.stop_id = 5;
    status.stop_engaged = i < 50 ? 1 : 0;
    watch.hear(status);
  }
  EXPECT_EQ(watch.clauses()[1].verdict(), Verdict::kBroken);
}

TEST(RequestWatch, FindsMotorsThatComeOnWithARelease) {
  RequestWatch watch;
  robot_status_t status = status_at(kStart);
  status.motors_enabled = 0;
  watch.hear(status);
  watch.hear(stop_of(5, false));
  for (int i = 1; i < 10; ++i) {
    status.utime = kStart + i * kTick;
    status.stop_id = 5;
    status.motors_enabled = i < 5 ? 0 : 1;
    watch.hear(status);
  }
  EXPECT_EQ(watch.clauses()[4].verdict(), Verdict::kBroken);
}

TEST(BaseExercise, ComesToItsEndByTheStampsOfTheBaseAlone) {
  lcm::LCM lcm("memq://");
  BaseExercise exercise(lcm, "p3dx");
  int ticks = 0;
  for (; !exercise.is_done() && ticks < 10'000; ++ticks) {
    exercise.hear(status_at(kStart + ticks * kTick));
  }
  EXPECT_EQ(exercise.refusal(), "");
  EXPECT_LT(ticks, 45 * 50) << "45 s";
}

TEST(BaseExercise, DoesNotBeginWithMotorsOff) {
  lcm::LCM lcm("memq://");
  BaseExercise exercise(lcm, "p3dx");
  for (int i = 0; i < 200; ++i) {
    robot_status_t status = status_at(kStart + i * kTick);
    status.motors_enabled = 0;
    exercise.hear(status);
  }
  EXPECT_THAT(exercise.refusal(), testing::HasSubstr("motors are off"));
}

}  // namespace
}  // namespace luminav
