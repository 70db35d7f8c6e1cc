#include "services/launcher/sheriff/sheriff.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "services/common/configuration/toml_table.hpp"
#include "services/launcher/sheriff/status_table.hpp"
#include "tests/node/launcher/launcher_world.hpp"

namespace luminav::launcher {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::string kOlder = "host:1:1000";
const std::string kYounger = "host:2:2000";

class SheriffTest : public ::testing::Test {
 protected:
  SheriffTest() { file.commands = {camera, mapper}; }
  static Target only(const std::string& name) { return {Target::Kind::kCommand, name}; }
  LauncherWorld world;
  const Command camera = LauncherWorld::command("camera", true);
  const Command mapper = LauncherWorld::command("mapper");
  PmdFile file;
};

TEST_F(SheriffTest, StartsEverythingAndKnowsWhenItIsReady) {
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(1.0);
  EXPECT_EQ(sheriff.states()[0].condition, Condition::kUnknown);
  EXPECT_EQ(world.orders_heard, 0) << "no orders before a deputy is heard";
  world.add_deputy(file.commands);
  world.run(1.0);
  EXPECT_THAT(world.runner.running, SizeIs(2));
  EXPECT_FALSE(sheriff.all_ready({}));
  EXPECT_TRUE(sheriff.deputies_heard({}));
  world.say_ready("camera");
  world.say_ready("mapper");
  EXPECT_TRUE(sheriff.all_ready({}));
  EXPECT_TRUE(sheriff.all_ready(only("camera")));
}

TEST_F(SheriffTest, ALeftoverOnAnotherHostDoesNotSpeakForOneThatHangs) {
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(1.0);
  const auto say = [&](const char* process, const char* host) {
    world.say_ready(process, node_status_t::STATE_READY, host);
  };
  say("camera", "other");
  EXPECT_TRUE(sheriff.all_ready(only("camera"))) << "the only one that speaks";
  say("camera", "ours");
  const CommandState undecided = sheriff.states(only("camera"))[0];
  EXPECT_EQ(undecided.condition, Condition::kUnknown);
  EXPECT_THAT(undecided.detail, HasSubstr("on other and on ours"));
  say("mapper", "ours");
  EXPECT_TRUE(sheriff.all_ready({})) << "most of the deputy's commands speak there";
  for (int second = 0; second < 4; ++second) {
    world.run(1.0);
    say("camera", "other");
    say("mapper", "ours");
  }
  EXPECT_EQ(sheriff.states(only("camera"))[0].condition, Condition::kSilent);
  EXPECT_TRUE(sheriff.all_ready(only("mapper")));
  sheriff.restart(only("camera"));
  world.run(1.0);
  say("camera", "other");
  EXPECT_EQ(sheriff.states(only("camera"))[0].condition, Condition::kStarting);
  say("camera", "ours");
  EXPECT_TRUE(sheriff.all_ready(only("camera")));
}

TEST_F(SheriffTest, DoesNotKnowWhichOfTwoNamesakesSpeaks) {
  file.commands[1].exec = camera.exec + " --second";
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(1.0);
  world.say_ready("camera");
  for (const CommandState& state : sheriff.states()) {
    EXPECT_EQ(state.condition, Condition::kUnknown) << state.name;
    EXPECT_THAT(state.detail, HasSubstr("calls itself camera too"));
  }
  sheriff.stop(only("mapper"));
  world.run(1.0);
  world.say_ready("camera");
  EXPECT_TRUE(sheriff.all_ready(only("camera"))) << "alone again";
}

TEST_F(SheriffTest, RepeatsItsOrdersOnceASecondAndAtEveryChange) {
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  world.run(2.0);
  const int before = world.orders_heard;
  world.run(5.0);
  EXPECT_EQ(world.orders_heard - before, 5);
  sheriff.start(only("camera"));
  world.run(0.05);
  EXPECT_EQ(world.orders_heard - before, 6);
}

TEST_F(SheriffTest, TakesOverARunningSystemWithoutRestartingIt) {
  world.add_deputy(file.commands);
  world.add_sheriff(file, kOlder).start({});
  world.run(2.0);
  world.sheriffs.clear();
  Sheriff& second = world.add_sheriff(file, kYounger);
  second.start({});
  world.run(3.0);
  EXPECT_THAT(world.runner.started, SizeIs(2));
  EXPECT_THAT(world.runner.signals, IsEmpty());
  EXPECT_TRUE(second.states()[0].uptime_at_least);
  world.sheriffs.clear();
  Sheriff& without_file = world.add_sheriff({}, "host:3:3000");
  world.run(3.0);
  EXPECT_THAT(without_file.states(), SizeIs(2));
  EXPECT_THAT(world.runner.signals, IsEmpty());
  without_file.stop(only("mapper"));
  world.run(0.2);
  EXPECT_TRUE(without_file.all_stopped(only("mapper")));
  EXPECT_THAT(world.runner.running, SizeIs(1));
}

TEST_F(SheriffTest, RestartsStopsAndStartsATarget) {
  file.commands[1].group = "services/inner";
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(1.0);
  sheriff.restart(only("camera"));
  world.run(0.2);
  EXPECT_THAT(world.runner.started, SizeIs(3));
  sheriff.stop({Target::Kind::kGroup, "services"});
  world.run(0.2);
  EXPECT_THAT(world.runner.running, SizeIs(1));
  sheriff.start({Target::Kind::kGroup, "services"});
  world.run(0.2);
  EXPECT_THAT(world.runner.running, SizeIs(2));
  EXPECT_THROW(sheriff.start(only("nobody")), ConfigurationError);
}

TEST_F(SheriffTest, RemovesACommandFromItsDeputy) {
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(1.0);
  sheriff.remove(only("mapper"));
  world.run(1.0);
  EXPECT_EQ(world.listed("mapper").pid, -1);
  EXPECT_THAT(sheriff.states(), SizeIs(1));
}

TEST_F(SheriffTest, StartsAgainWhatADeputyThatWasRestartedForgot) {
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(1.0);
  sheriff.stop(only("mapper"));
  world.run(1.0);
  world.deputies.clear();
  world.runner.running.clear();
  world.add_deputy(file.commands);
  world.run(2.0);
  EXPECT_THAT(world.runner.running, SizeIs(1)) << "the camera, but not the mapper that was stopped";
  EXPECT_EQ(sheriff.states()[0].restarts, 1);
}

TEST_F(SheriffTest, OnlyListensWhenObserving) {
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  Sheriff& observer = world.add_sheriff({}, kYounger, true);
  sheriff.start({});
  world.run(2.0);
  EXPECT_EQ(world.last_sheriff, kOlder);
  EXPECT_FALSE(sheriff.yielding());
  EXPECT_THAT(observer.states(), SizeIs(2));
  world.say_ready("camera");
  EXPECT_TRUE(observer.all_ready(only("camera")));
  sheriff.stop(only("mapper"));
  world.run(0.5);
  EXPECT_EQ(observer.states(only("mapper"))[0].condition, Condition::kStopped);
}

TEST_F(SheriffTest, YieldsToASheriffThatStartedLaterAndTakesCommandBack) {
  world.add_deputy(file.commands);
  Sheriff& older = world.add_sheriff(file, kOlder);
  older.start({});
  world.run(2.0);
  Sheriff& younger = world.add_sheriff({}, kYounger);
  world.run(1.0);
  younger.stop(only("camera"));
  world.run(1.0);
  EXPECT_TRUE(older.yielding());
  EXPECT_THAT(world.runner.running, SizeIs(1));
  world.sheriffs.pop_back();
  world.run(6.0);
  EXPECT_FALSE(older.yielding());
  EXPECT_EQ(world.last_sheriff, kOlder);
  EXPECT_THAT(world.runner.running, SizeIs(1)) << "it remembers what the other one ordered";
  EXPECT_THAT(world.runner.started, SizeIs(2)) << "and nothing was started in between";
}

TEST_F(SheriffTest, CommandsADeputyWhoseClockIsWrongAndSaysSo) {
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  std::string notices;
  sheriff.report_notices([&](const std::string& notice) { notices += notice + "\n"; });
  sheriff.start({});
  const auto run_with_clock_ahead = [&](std::int64_t seconds) {
    for (int i = 0; i < 60; ++i) {
      world.now.steady += 50'000;
      world.now.utime += 50'000;
      Instant ahead = world.now;
      ahead.utime += seconds * kSecond;
      world.deputies[0]->tick(ahead);
      sheriff.tick(world.now);
      world.pump();
    }
  };
  run_with_clock_ahead(3600);
  EXPECT_THAT(world.runner.running, SizeIs(2));
  EXPECT_THAT(notices, HasSubstr("3600 s ahead"));
  run_with_clock_ahead(7200);
  EXPECT_THAT(notices, HasSubstr("7200 s ahead")) << "said again when it is set";
  notices.clear();
  run_with_clock_ahead(7200);
  EXPECT_EQ(notices, "") << "and only then";
}

TEST_F(SheriffTest, SaysThatADeputyHasGone) {
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  std::string notices;
  sheriff.report_notices([&](const std::string& notice) { notices += notice + "\n"; });
  world.run(2.0);
  world.deputies.clear();
  world.run(6.0);
  EXPECT_THAT(notices, HasSubstr("deputy d has not been heard for 5 s"));
  EXPECT_EQ(sheriff.states()[0].condition, Condition::kUnknown);
  EXPECT_FALSE(sheriff.deputies_heard({}));
}

TEST_F(SheriffTest, ShowsARefusedCommandOfItsOwnAndForgetsAStrangers) {
  world.add_deputy({camera});
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(1.0);
  EXPECT_EQ(sheriff.states(only("mapper"))[0].condition, Condition::kRefused);
  EXPECT_EQ(sheriff.states(only("camera"))[0].condition, Condition::kStarting);
  EXPECT_THAT(sheriff.states(), SizeIs(2));
}

TEST_F(SheriffTest, FillsATable) {
  file.commands[1].group = "services";
  world.add_deputy(file.commands);
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  sheriff.start({});
  world.run(2.0);
  world.say_ready("camera");
  const std::vector<std::string> lines = status_table(sheriff, 0);
  EXPECT_THAT(lines, Contains(HasSubstr("camera")));
  EXPECT_THAT(lines, Contains("services"));
  EXPECT_THAT(lines, Contains(HasSubstr("ready")));
  for (const std::string& line : status_table(sheriff, 30)) {
    EXPECT_LE(line.size(), 30U);
  }
  EXPECT_EQ(format_duration(7.9), "0:07");
  EXPECT_EQ(format_duration(751.0), "12:31");
  EXPECT_EQ(format_duration(10800.0), "3:00:00");
  EXPECT_EQ(format_duration(2 * 86400.0 + 4 * 3600.0 + 600.0), "2d 04:10");
}

TEST_F(SheriffTest, SurvivesGarbage) {
  Sheriff& sheriff = world.add_sheriff(file, kOlder);
  for (const char* channel :
       {channels::kProcmanInfo, channels::kProcmanOrders, channels::kProcmanOutput, channels::kNodeStatus}) {
    const std::vector<std::uint8_t> bytes(37, 0xff);
    for (unsigned length = 0; length < bytes.size(); ++length) {
      world.lcm.publish(channel, bytes.data(), length);
    }
  }
  world.pump();
  EXPECT_GT(sheriff.dropped(), 0);
  world.add_deputy(file.commands);
  sheriff.start({});
  world.run(1.0);
  EXPECT_THAT(world.runner.running, SizeIs(2));
}

}  // namespace
}  // namespace luminav::launcher
