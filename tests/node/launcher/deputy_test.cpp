#include "services/launcher/deputy/deputy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/launcher/exit_status.hpp"
#include "tests/node/launcher/launcher_world.hpp"

namespace luminav::launcher {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;

class DeputyTest : public ::testing::Test {
 protected:
  DeputyTest() {
    world.add_deputy({camera, mapper});
    world.run(0.7);
  }
  LauncherWorld world;
  const Command camera = LauncherWorld::command("camera", true);
  const Command mapper = LauncherWorld::command("mapper");
};

TEST_F(DeputyTest, SaysWhatItRunsOnceASecondAndAtEveryChange) {
  const int before = world.infos;
  world.run(3.0);
  EXPECT_EQ(world.infos - before, 3);
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.run(0.05);
  EXPECT_EQ(world.infos - before, 4);
  const auto status = world.listed("camera");
  EXPECT_EQ(status.pid, 101);
  EXPECT_EQ(status.actual_runid, 1);
  EXPECT_EQ(status.cmd.exec_str, camera.exec);
  EXPECT_EQ(status.cmd.auto_respawn, 1);
  EXPECT_EQ(status.cmd.stop_signal, 2);
  EXPECT_EQ(world.info.deputy_id, "d");
}

TEST_F(DeputyTest, AnswersADiscoveryAtOnce) {
  const int before = world.infos;
  luminav_procman::procman_discovery_t discovery{};
  discovery.utime = 1;
  discovery.transmitter_id = "sheriff";
  world.lcm.publish(channels::kProcmanDiscover, &discovery);
  world.pump();
  world.run(0.05);
  EXPECT_EQ(world.infos, before + 1);
}

TEST_F(DeputyTest, RestartsInOneGoWithASingleOrder) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.order("s", {LauncherWorld::desired(camera, 2)});
  world.run(0.1);
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 2)));
  EXPECT_EQ(world.listed("camera").pid, 102);
  EXPECT_EQ(world.listed("camera").actual_runid, 2);
}

TEST_F(DeputyTest, KillsAStubbornProcessByItsOwnTimer) {
  world.runner.stubborn.insert("$LUMINAV_BIN/mapper");
  world.order("s", {LauncherWorld::desired(mapper, 1)});
  world.order("s", {LauncherWorld::desired(mapper, 1, true)});
  world.run(6.9);
  EXPECT_EQ(world.listed("mapper").pid, 101);
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 2)));
  world.run(0.3);
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 2), Pair(101, 9)));
  EXPECT_EQ(world.listed("mapper").pid, 0);
  EXPECT_EQ(world.listed("mapper").exit_code, 9);
}

TEST_F(DeputyTest, UsesTheStopSignalOfTheOrders) {
  Command gentle = mapper;
  gentle.stop_signal = 15;
  world.order("s", {LauncherWorld::desired(gentle, 1)});
  world.order("s", {LauncherWorld::desired(gentle, 1, true)});
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 15)));
}

TEST_F(DeputyTest, ReplacesSignalsAndTimesThatMakeNoSense) {
  Command odd = mapper;
  odd.stop_signal = 0;
  odd.stop_time_allowed = -1.0;
  world.order("s", {LauncherWorld::desired(odd, 1)});
  world.order("s", {LauncherWorld::desired(odd, 1, true)});
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 2)));
}

TEST_F(DeputyTest, SendsNoSignalThatDoesNotEndAProcess) {
  int pid = 101;
  int run = 0;
  for (const int signal : {19, 18, 20, 23, 9}) {  // STOP, CONT, TSTP, URG; KILL leaves a driver no time to brake
    Command frozen = mapper;
    frozen.stop_signal = signal;
    frozen.stop_time_allowed = 3600.0;
    world.order("s", {LauncherWorld::desired(frozen, ++run)});
    world.order("s", {LauncherWorld::desired(frozen, run, true)});
    world.run(0.1);
    EXPECT_THAT(world.runner.signals, ElementsAre(Pair(pid++, 2))) << signal;
    world.runner.signals.clear();
  }
}

TEST_F(DeputyTest, WaitsNoLongerForAProcessToEndThanItsOwnFileSaysOrTenSeconds) {
  world.runner.stubborn.insert("$LUMINAV_BIN/mapper");
  Command patient = mapper;
  patient.stop_time_allowed = 3600.0;
  world.order("s", {LauncherWorld::desired(patient, 1)});
  world.order("s", {LauncherWorld::desired(patient, 1, true)});
  world.run(10.3);
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 2), Pair(101, 9)));
}

TEST_F(DeputyTest, UsesAnySignalOfItsOwnFile) {
  Command own = LauncherWorld::command("logger");
  own.stop_signal = 10;
  LauncherWorld other;
  other.add_deputy({own});
  other.run(0.7);
  other.order("s", {LauncherWorld::desired(own, 1)});
  other.order("s", {LauncherWorld::desired(own, 1, true)});
  EXPECT_THAT(other.runner.signals, ElementsAre(Pair(101, 10)));
}

TEST_F(DeputyTest, StopsARunningProcessWhateverItsWordsInTheOrders) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  Command edited = camera;
  edited.exec += " --verbose";
  world.order("s", {LauncherWorld::desired(edited, 2)});
  world.run(0.1);
  EXPECT_EQ(world.listed("camera").pid, 101) << "other words are not run";
  world.order("s", {LauncherWorld::desired(edited, 2, true)});
  world.run(0.1);
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 2)));
  EXPECT_EQ(world.listed("camera").pid, 0);
  EXPECT_EQ(world.listed("camera").cmd.exec_str, camera.exec);
  world.run(3.0);
  EXPECT_THAT(world.runner.running, IsEmpty()) << "it was stopped for good";
  world.order("s", {LauncherWorld::desired(camera, 3)});
  world.run(0.1);
  EXPECT_EQ(world.listed("camera").pid, 102);
}

TEST_F(DeputyTest, RestartsWhatDiedAndGivesUpInTheEnd) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  int deaths = 0;
  for (; deaths < 100 && !world.runner.running.empty(); ++deaths) {
    world.runner.end(world.runner.last_pid, 3 << 8);
    world.run(5.5);
  }
  EXPECT_EQ(deaths, RespawnParams{}.limit + 1);
  EXPECT_EQ(world.listed("camera").exit_code, kGaveUpStatus);
  EXPECT_EQ(world.listed("camera").actual_runid, 1);
  EXPECT_THAT(world.output, HasSubstr("stays stopped"));
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.run(1.0);
  EXPECT_THAT(world.runner.running, IsEmpty()) << "the same run is not started again";
  world.order("s", {LauncherWorld::desired(camera, 2)});
  world.run(0.1);
  EXPECT_THAT(world.runner.running, SizeIs(1)) << "a new start begins anew";
}

TEST_F(DeputyTest, IsBackWithinHalfASecondAfterACrash) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.runner.end(101, 11);
  world.run(0.2);
  EXPECT_EQ(world.listed("camera").pid, 102);
  EXPECT_EQ(world.listed("camera").actual_runid, 1) << "the same run, as procman counts";
}

TEST_F(DeputyTest, TriesAgainWhenAStartFails) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.runner.failing_starts = 2;
  world.runner.end(101, 11);
  world.run(0.5);
  EXPECT_EQ(world.runner.failing_starts, 0);
  EXPECT_EQ(world.listed("camera").pid, 102);

  world.runner.failing_starts = 1000;
  world.runner.end(102, 11);
  world.run(60.0);
  EXPECT_EQ(world.listed("camera").pid, 0);
  EXPECT_EQ(world.listed("camera").exit_code, kGaveUpStatus);
  EXPECT_THAT(world.output, HasSubstr("the last time: no process to be had"));
}

TEST_F(DeputyTest, DoesNotRestartWhatWasToRunOnce) {
  world.order("s", {LauncherWorld::desired(mapper, 1)});
  world.runner.end(101, 0);
  world.run(3.0);
  EXPECT_THAT(world.runner.running, IsEmpty());
  EXPECT_EQ(world.listed("mapper").exit_code, 0);
}

TEST_F(DeputyTest, DoesNotRestartWhatWasStopped) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.order("s", {LauncherWorld::desired(camera, 1, true)});
  world.run(10.0);
  EXPECT_THAT(world.runner.started, SizeIs(1));
}

TEST_F(DeputyTest, ForgetsWhatIsMissingFromTheOrdersOnceItIsDead) {
  world.runner.stubborn.insert("$LUMINAV_BIN/mapper");
  world.order("s", {LauncherWorld::desired(camera, 1), LauncherWorld::desired(mapper, 1)});
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.run(1.0);
  EXPECT_EQ(world.listed("mapper").pid, 102);
  world.run(7.0);
  EXPECT_EQ(world.listed("mapper").pid, -1);
  EXPECT_EQ(world.listed("camera").pid, 101);
}

TEST_F(DeputyTest, DoesNothingWithAStrangersCommandButSayAndListItAsRefused) {
  world.order("h:1:100", {LauncherWorld::desired(camera, 1)});
  world.run(4.0);  // its sheriff is gone
  Command invented = mapper;
  invented.name = "evil";
  invented.exec = "sh -c 'touch /tmp/owned'";
  world.order("h:9:999", {LauncherWorld::desired(invented, 7)});
  world.run(1.0);
  EXPECT_THAT(world.runner.started, SizeIs(1));
  EXPECT_THAT(world.runner.signals, IsEmpty()) << "what runs goes on";
  EXPECT_EQ(world.listed("camera").pid, 101);
  const auto refused = world.listed("evil");
  EXPECT_EQ(refused.pid, 0);
  EXPECT_EQ(refused.actual_runid, 7);
  EXPECT_EQ(refused.exit_code, 126 << 8);
  EXPECT_THAT(world.output, HasSubstr("refused command \"evil\""));
}

TEST_F(DeputyTest, RefusesOtherWordsForACommandItKnows) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  Command changed = camera;
  changed.exec = "rm -rf /";
  world.order("s", {LauncherWorld::desired(changed, 2)});
  world.run(1.0);
  EXPECT_THAT(world.runner.signals, IsEmpty());
  EXPECT_EQ(world.listed("camera").pid, 101);
  EXPECT_EQ(world.listed("camera").cmd.exec_str, camera.exec);
  EXPECT_THAT(world.output, HasSubstr("refused other words"));
}

TEST_F(DeputyTest, CannotBeFilledWithRefusedCommands) {
  std::vector<luminav_procman::procman_command_desired_t> many;
  for (int i = 0; i < 1000; ++i) {
    Command invented = mapper;
    invented.name = "x" + std::to_string(i) + std::string(5000, 'n');
    invented.exec = std::string(5000, 'e');
    many.push_back(LauncherWorld::desired(invented, 1));
  }
  world.order("s", many);
  world.run(1.0);
  EXPECT_LT(world.info.getEncodedSize(), 60'000);
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.run(0.1);
  EXPECT_THAT(world.info.cmds, SizeIs(1)) << "honest orders clear them away";
}

TEST_F(DeputyTest, RunsAnythingWhenToldSo) {
  LauncherWorld open;
  DeputyConfig config;
  config.id = "d";
  config.allow_any = true;
  open.deputies.push_back(std::make_unique<Deputy>(open.lcm, config, open.runner));
  open.run(0.7);
  open.order("s", {LauncherWorld::desired(camera, 1)});
  EXPECT_THAT(open.runner.started, SizeIs(1));
}

TEST_F(DeputyTest, IgnoresOrdersThatAreAMinuteOldAndSaysSo) {
  world.order("s", {LauncherWorld::desired(camera, 1)}, 61 * kSecond);
  world.run(0.2);
  EXPECT_THAT(world.runner.started, IsEmpty());
  EXPECT_THAT(world.output, HasSubstr("61 s old"));
  world.order("s", {LauncherWorld::desired(camera, 1)}, 59 * kSecond);
  EXPECT_THAT(world.runner.started, SizeIs(1));
}

TEST_F(DeputyTest, ObeysOrdersFromTheFuture) {
  world.order("s", {LauncherWorld::desired(camera, 1)}, -3600 * kSecond);
  EXPECT_THAT(world.runner.started, SizeIs(1));
}

TEST_F(DeputyTest, IgnoresOrdersForOthers) {
  luminav_procman::procman_orders_t orders{};
  orders.utime = world.now.utime;
  orders.deputy_id = "another";
  orders.cmds = {LauncherWorld::desired(camera, 1)};
  orders.ncmds = 1;
  world.lcm.publish(channels::kProcmanOrders, &orders);
  world.pump();
  EXPECT_THAT(world.runner.started, IsEmpty());
}

TEST_F(DeputyTest, SendsWhatTheCommandsPrint) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.runner.printed.push_back({101, "hello\n"});
  world.run(0.2);
  EXPECT_THAT(world.output, HasSubstr("hello\n"));
}

TEST_F(DeputyTest, SurvivesGarbageOnEveryChannel) {
  const std::vector<std::uint8_t> orders_with_absurd_count = {0xd3, 0x43, 0xf4, 0x5b, 0x17, 0x1a, 0xb8, 0x55, 0, 0, 0,
                                                              0,    0,    0,    0,    0,    0,    0,    0,    1, 0, 0,
                                                              0,    0,    1,    0,    0xff, 0xff, 0xff, 0xff};
  std::vector<std::vector<std::uint8_t>> all = {{}, {1, 2, 3}, orders_with_absurd_count};
  for (std::size_t length = 0; length < orders_with_absurd_count.size(); ++length) {
    all.emplace_back(orders_with_absurd_count.begin(),
                     orders_with_absurd_count.begin() + static_cast<std::ptrdiff_t>(length));
  }
  for (const auto& bytes : all) {
    for (const char* channel : {channels::kProcmanOrders, channels::kProcmanInfo, channels::kProcmanDiscover}) {
      world.lcm.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
    }
  }
  world.pump();
  EXPECT_GT(world.deputies[0]->dropped(), 0);
  world.order("s", {LauncherWorld::desired(camera, 1)});
  EXPECT_THAT(world.runner.started, SizeIs(1));
}

TEST_F(DeputyTest, GivesWayToADeputyOfItsNameThatIsThereAlready) {
  Deputy& second = world.add_deputy({camera}, 6);
  world.run(1.2);
  ASSERT_TRUE(second.conflict().has_value());
  EXPECT_FALSE(world.deputies[0]->conflict().has_value());
}

TEST_F(DeputyTest, OfTwoThatStartTogetherOneStays) {
  LauncherWorld both;
  both.add_deputy({camera}, 5);
  both.add_deputy({camera}, 6);
  both.run(1.0);
  EXPECT_FALSE(both.deputies[0]->conflict().has_value());
  EXPECT_TRUE(both.deputies[1]->conflict().has_value());
}

TEST_F(DeputyTest, StopsEverythingWhenItEnds) {
  world.runner.stubborn.insert("$LUMINAV_BIN/mapper");
  world.order("s", {LauncherWorld::desired(camera, 1), LauncherWorld::desired(mapper, 1)});
  world.deputies[0]->begin_shutdown();
  world.run(0.1);
  EXPECT_FALSE(world.deputies[0]->all_stopped());
  world.order("s", {LauncherWorld::desired(camera, 2), LauncherWorld::desired(mapper, 1)});
  world.run(5.5);
  EXPECT_TRUE(world.deputies[0]->all_stopped());
  EXPECT_THAT(world.runner.started, SizeIs(2)) << "orders are not obeyed any more";
  EXPECT_EQ(world.listed("camera").pid, 0);
}

TEST_F(DeputyTest, StartsAProcessAnewThatUsesTooMuchMemory) {
  world.order("s", {LauncherWorld::desired(camera, 1)});
  world.run(2.0);
  EXPECT_THAT(world.runner.signals, IsEmpty());
  world.runner.resident_bytes = 60'000'000;
  world.run(1.1);
  EXPECT_THAT(world.runner.signals, ElementsAre(Pair(101, 2)));
  world.runner.resident_bytes = 3000;
  world.run(1.0);
  EXPECT_EQ(world.listed("camera").pid, 102);
  EXPECT_THAT(world.output, HasSubstr("uses 60 MB"));
}

TEST_F(DeputyTest, KillsAProcessThatUsesTooMuchMemoryAndDoesNotEnd) {
  world.runner.stubborn.insert("$LUMINAV_BIN/camera");
  world.runner.resident_bytes = 60'000'000;
  for (int second = 0; second < 9; ++second) {  // the orders come once a second
    world.order("s", {LauncherWorld::desired(camera, 1)});
    world.run(1.0);
  }
  EXPECT_THAT(world.runner.signals, ::testing::Contains(Pair(101, 9)));
}

}  // namespace
}  // namespace luminav::launcher
