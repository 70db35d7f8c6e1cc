#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/node/contract/base_under_test.hpp"

namespace luminav {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

std::vector<std::string> broken(const std::vector<Clause>& clauses) {
  return with_verdict(clauses, Clause::Verdict::kBroken);
}

std::vector<std::string> not_seen(const std::vector<Clause>& clauses) {
  return with_verdict(clauses, Clause::Verdict::kNotSeen);
}

TEST(CheckBase, FindsThatTheSimulatedP3dxKeepsEveryClause) {
  BaseUnderTest base;
  const std::vector<Clause> clauses = base.judge();
  ASSERT_TRUE(base.is_done());
  EXPECT_EQ(base.refusal(), "");
  EXPECT_THAT(broken(clauses), IsEmpty()) << describe(clauses);
  EXPECT_THAT(not_seen(clauses), IsEmpty()) << describe(clauses);
  EXPECT_EQ(exit_status(clauses, true), 0);
}

TEST(CheckBase, OnlyListensUnlessItIsToldToDrive) {
  BaseUnderTest base(P3dxBench::robot_config(), false);
  const std::vector<Clause> clauses = base.judge(10.0);
  EXPECT_DOUBLE_EQ(base.bench().base.travel, 0.0);
  EXPECT_DOUBLE_EQ(base.bench().base.turned, 0.0);
  EXPECT_THAT(broken(clauses), IsEmpty()) << describe(clauses);
  EXPECT_THAT(not_seen(clauses), Contains(StartsWith("VELOCITY_COMMAND: a fresh one moves it")));
  EXPECT_EQ(exit_status(clauses, false), 0);
  EXPECT_EQ(exit_status(clauses, true), 1) << "who drives wants to have seen all of it";
}

TEST(CheckBase, FindsADriverOfHalfTheRate) {
  BaseUnderTest base;
  int count = 0;
  base.status = [&](robot_status_t& message) {
    message.sequence = ++count / 2;  // it numbers what it sends
    return count % 2 == 0;
  };
  const std::vector<Clause> clauses = base.judge(120.0);
  EXPECT_THAT(broken(clauses), ElementsAre(StartsWith("ROBOT_STATUS: 50 Hz"))) << describe(clauses);
  EXPECT_EQ(exit_status(clauses, false), 1);
}

TEST(CheckBase, FindsStampsThatGoBack) {
  BaseUnderTest base;
  base.odometry = [](odometry_t& message) {
    message.utime -= message.sequence % 50 == 49 ? 150'000 : 0;
    return true;
  };
  const std::vector<Clause> clauses = base.judge();
  EXPECT_THAT(broken(clauses), Contains(StartsWith("ODOMETRY: stamps grow"))) << describe(clauses);
  EXPECT_EQ(exit_status(clauses, false), 1);
}

TEST(CheckBase, FindsMotionAfterTheLastCommandHasTimedOut) {
  P3dxConfig config = P3dxBench::robot_config();
  config.command_timeout = 1.0;
  BaseUnderTest base(config);
  const std::vector<Clause> clauses = base.judge();
  EXPECT_THAT(broken(clauses), Contains(StartsWith("VELOCITY_COMMAND: nothing else moves it"))) << describe(clauses);
  EXPECT_EQ(exit_status(clauses, false), 1);
}

TEST(CheckBase, FindsStampsThatClaimAnotherRate) {
  BaseUnderTest base(P3dxBench::robot_config(), false);
  std::int64_t first = 0;
  base.odometry = [&](odometry_t& message) {
    first = first == 0 ? message.utime : first;
    message.utime = first + 2 * (message.utime - first);
    return true;
  };
  EXPECT_THAT(broken(base.judge(10.0)), Contains(StartsWith("ODOMETRY: stamps advance as time does")));
}

TEST(CheckBase, FindsADriverThatIsDeafToAStop) {
  BaseUnderTest base;
  base.stop = [](stop_t&) { return false; };
  const std::vector<Clause> clauses = base.judge();
  EXPECT_THAT(broken(clauses), Contains(StartsWith("STOP: it brakes and stands"))) << describe(clauses);
  EXPECT_THAT(broken(clauses), Contains(StartsWith("STOP: ROBOT_STATUS echoes")));
}

TEST(CheckBase, FindsADriverThatObeysWhateverIsSaid) {
  BaseUnderTest base;
  std::int32_t sequence = 0;
  base.command = [&](velocity_command_t& message) {
    message.utime = base.bench().clock.utime();
    message.robot = P3dxBench::robot_config().robot.name;
    message.sequence = ++sequence;
    return true;
  };
  const std::vector<Clause> clauses = base.judge();
  EXPECT_THAT(broken(clauses), Contains(StartsWith("VELOCITY_COMMAND: nothing else moves it"))) << describe(clauses);
  EXPECT_THAT(broken(clauses), Contains(HasSubstr("commands_refused counts")));
}

TEST(CheckBase, FindsADriverThatKeepsItsMotorsOn) {
  BaseUnderTest base;
  base.motors = [](motors_command_t& message) {
    message.enable = 1;
    return true;
  };
  EXPECT_THAT(broken(base.judge()), Contains(StartsWith("MOTORS_COMMAND: the motors are what was asked for")));
}

TEST(CheckBase, FindsATwistThatIsNotThatOfThePose) {
  BaseUnderTest base;
  base.odometry = [](odometry_t& message) {
    message.linear *= 0.5;
    message.angular *= 0.5;
    return true;
  };
  EXPECT_THAT(broken(base.judge()), Contains(StartsWith("ODOMETRY: the pose moves as")));
}

TEST(CheckBase, FindsSonarsThatRepeatTheirLastReading) {
  BaseUnderTest base(P3dxBench::robot_config(), false);
  base.sonar = [](sonar_t& message) {
    message.fresh.assign(message.fresh.size(), 1);
    return true;
  };
  EXPECT_THAT(broken(base.judge(10.0)), ElementsAre(StartsWith("SONAR: each range with its own time")));
}

TEST(CheckBase, FindsADriverThatSaysNothing) {
  BaseUnderTest base(P3dxBench::robot_config(), false);
  base.status = [](robot_status_t&) { return false; };
  const std::vector<Clause> clauses = base.judge(5.0);
  EXPECT_THAT(broken(clauses), Contains(StartsWith("ROBOT_STATUS: 50 Hz")));
  EXPECT_EQ(exit_status(clauses, false), 1);
}

TEST(CheckBase, DoesNotDriveARobotThatAnotherDrives) {
  BaseUnderTest base;
  base.status = [&base, sequence = 0](robot_status_t& message) mutable {
    velocity_command_t command{};
    command.utime = message.utime;
    command.robot = message.robot;
    command.session = 7;
    command.sequence = ++sequence;
    base.say(command);
    return true;
  };
  base.judge();
  EXPECT_THAT(base.refusal(), HasSubstr("another process commands"));
  EXPECT_DOUBLE_EQ(base.bench().base.turned, 0.0);
}

TEST(CheckBase, DoesNotDriveARobotThatIsStopped) {
  BaseUnderTest base;
  base.bench().send_stop(5, true);
  base.judge();
  EXPECT_THAT(base.refusal(), HasSubstr("a stop is in force"));
  EXPECT_DOUBLE_EQ(base.bench().base.turned, 0.0);
}

}  // namespace
}  // namespace luminav
