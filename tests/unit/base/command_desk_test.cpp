#include "drivers/base/command_desk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kSecond = 1'000'000;  // [us]

/// Writes down what it is told.
class WrittenBase final : public CommandedBase {
 public:
  std::vector<std::string> told;
  std::int64_t pause = 0;  // [us]

  void follow(std::int64_t) override { told.emplace_back("follow"); }
  void follow_stop(std::int64_t) override { told.emplace_back("stop"); }
  void switch_motors(std::int64_t, bool enable) override { told.emplace_back(enable ? "on" : "off"); }
  void stand_after_gap(std::int64_t) override { told.emplace_back("stand"); }
  void begin_anew(std::int64_t, std::int64_t for_guardian) override {
    told.emplace_back("anew");
    pause = for_guardian;
  }
};

class CommandDeskTest : public testing::Test {
 protected:
  static BaseConfig config() {
    BaseConfig config;
    config.guardian_done_after = 1.0;
    config.robot.limits.linear = 0.5;
    return config;
  }
  void deliver() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  void command(double linear, const std::string& robot = "p3dx") {
    velocity_command_t message{};
    message.utime = clock_.utime();
    message.robot = robot;
    message.session = 1;
    message.sequence = ++sequence_;
    message.linear_x = linear;
    lcm_.publish(channels::kVelocityCommand, &message);
    deliver();
  }
  void ask_stop(bool engaged, std::int64_t id) {
    stop_t message{};
    message.id = id;
    message.utime = clock_.utime();
    message.engaged = engaged ? 1 : 0;
    message.sender = "somebody's page";
    lcm_.publish(channels::kStop, &message);
    deliver();
  }
  void ask_motors(bool enable, std::int64_t id) {
    motors_command_t message{};
    message.utime = clock_.utime();
    message.id = id;
    message.enable = enable ? 1 : 0;
    lcm_.publish(channels::kMotorsCommand, &message);
    deliver();
  }
  [[nodiscard]] double speed(const CommandDesk& desk) const { return desk.wanted(clock_.utime()).linear; }

  lcm::LCM lcm_{"memq://"};
  VirtualClock clock_;
  WrittenBase base_;

 private:
  std::int32_t sequence_ = 0;
};

TEST_F(CommandDeskTest, FollowsACommandUntilItIsTooOld) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  command(0.3);
  EXPECT_THAT(base_.told, ElementsAre("follow"));
  EXPECT_EQ(speed(desk), 0.3);
  EXPECT_EQ(desk.reason(clock_.utime(), "", false, false), "");
  clock_.advance(kSecond);
  EXPECT_EQ(speed(desk), 0.0);
  EXPECT_EQ(desk.reason(clock_.utime(), "", false, false), "no fresh command");
}

TEST_F(CommandDeskTest, DropsWhatIsMeantForAnotherRobot) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  command(0.3, "another");
  EXPECT_THAT(base_.told, IsEmpty());
  EXPECT_EQ(speed(desk), 0.0);
  EXPECT_EQ(desk.subscriber().dropped(), 1);
}

TEST_F(CommandDeskTest, StandsForAStopAndForgetsWhatWasAskedBefore) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  command(0.3);
  ask_stop(true, 7);
  ask_stop(true, 7);
  EXPECT_THAT(base_.told, ElementsAre("follow", "stop")) << "a repeated stop changes nothing";
  clock_.advance(10'000);
  command(0.3);
  EXPECT_EQ(speed(desk), 0.0);
  EXPECT_EQ(desk.reason(clock_.utime(), "an edge", true, true), "stop requested by somebody's page");
  clock_.advance(10'000);
  ask_stop(false, 8);
  EXPECT_EQ(speed(desk), 0.0) << "a release moves nothing by itself";
  clock_.advance(10'000);
  command(0.3);
  EXPECT_EQ(speed(desk), 0.3);
}

TEST_F(CommandDeskTest, StandsWhileItIsHeldAndForGood) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  command(0.3);
  EXPECT_TRUE(desk.hold("there are two of it"));
  EXPECT_FALSE(desk.hold("there are two of it"));
  EXPECT_EQ(speed(desk), 0.0);
  EXPECT_EQ(desk.reason(clock_.utime(), "", false, false), "there are two of it");
  desk.hold("");
  EXPECT_EQ(speed(desk), 0.3);
  EXPECT_FALSE(desk.stand_for_good({0.3, 0.0}));
  EXPECT_TRUE(desk.stand_for_good({0.01, 0.0}));
  EXPECT_EQ(speed(desk), 0.0);
}

TEST_F(CommandDeskTest, AsksForTheMotorsOnceForEachRequest) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  command(0.3);
  ask_motors(true, 5);
  EXPECT_EQ(speed(desk), 0.0) << "what was asked before is forgotten";
  ask_motors(false, 6);
  ask_motors(true, 5);  // a late copy
  EXPECT_THAT(base_.told, ElementsAre("follow", "on", "off"));
}

TEST_F(CommandDeskTest, EngagesTheStopWhenItShouldMoveAndNobodyWatches) {
  BaseConfig watched = config();
  watched.supervised = 2.0;
  CommandDesk desk(lcm_, watched, clock_, {}, base_);
  for (int i = 0; i < 11; ++i) {
    clock_.advance(kSecond / 5);
    desk.wake();
  }
  command(0.0);
  EXPECT_FALSE(desk.stop().engaged()) << "a robot that stands needs nobody";
  supervision_t watching{};
  watching.utime = clock_.utime();
  lcm_.publish(channels::kSupervision, &watching);
  deliver();
  command(0.3);
  EXPECT_FALSE(desk.stop().engaged());
  for (int i = 0; i < 11; ++i) {
    clock_.advance(kSecond / 5);
    desk.wake();
  }
  command(0.3);
  EXPECT_TRUE(desk.stop().engaged());
  EXPECT_EQ(speed(desk), 0.0);
}

TEST_F(CommandDeskTest, ForgetsCommandsWhenItSlept) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  desk.wake();
  command(0.3);
  clock_.advance(kSecond * 26 / 100);
  desk.wake();
  EXPECT_THAT(base_.told, ElementsAre("follow", "stand"));
  EXPECT_EQ(speed(desk), 0.0);
}

TEST_F(CommandDeskTest, BeginsANewSessionOnceAfterItsGuardianActed) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  desk.report_life([] {});
  desk.finish_poll(desk.wake());
  clock_.advance(kSecond * 4 / 10);
  desk.finish_poll(desk.wake());
  EXPECT_THAT(base_.told, ElementsAre("stand", "anew"));
  EXPECT_EQ(base_.pause, kSecond * 6 / 10) << "until its guardian has left the line";
  clock_.advance(10'000);
  desk.wake();
  EXPECT_EQ(base_.told.size(), 2U);
}

TEST_F(CommandDeskTest, TellsItsStateFiftyTimesASecond) {
  CommandDesk desk(lcm_, config(), clock_, {}, base_);
  command(0.3);
  int count = 0;
  for (int i = 0; i < 20; ++i) {
    if (const auto status = desk.due_status(clock_.utime(), true)) {
      EXPECT_EQ(status->sequence, count++);
      EXPECT_EQ(status->command_fresh, 1);
      EXPECT_EQ(status->maximum_linear, 0.5);
    }
    clock_.advance(10'000);
  }
  EXPECT_EQ(count, 10);
  ask_stop(true, 7);
  clock_.advance(20'000);
  const auto status = desk.due_status(clock_.utime(), true);
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(status->stop_engaged, 1);
  EXPECT_EQ(status->stop_id, 7);
  EXPECT_EQ(status->command_fresh, 0);
}

TEST_F(CommandDeskTest, StandsWhereTheKeptStopCannotBeRead) {
  BaseConfig kept = config();
  kept.state_folder = "/dev/null";  // no folder
  const CommandDesk desk(lcm_, kept, clock_, {}, base_);
  EXPECT_TRUE(desk.stop().engaged());
}

}  // namespace
}  // namespace luminav
