#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>

#include "tests/node/launcher/launcher_world.hpp"

// Both sides against partners that speak the types of procman's own package and names.
namespace luminav::launcher {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

template <typename Message>
class Inbox {
 public:
  Inbox(lcm::LCM& lcm, const std::string& channel) : subscriber_(lcm) {
    subscriber_.on(channel, &Inbox::on_message, this);
  }
  Message last{};
  int count = 0;

 private:
  void on_message(const Message& message) {
    last = message;
    ++count;
  }
  Subscriber subscriber_;
};

procman_lcm::cmd_desired_t order_for(const Command& command, int runid, bool force_quit) {
  procman_lcm::cmd_desired_t desired{};
  desired.cmd.command_id = command.name;
  desired.cmd.exec_str = command.exec;
  desired.cmd.stop_signal = 2;
  desired.cmd.stop_time_allowed = 7.0F;
  desired.desired_runid = runid;
  desired.force_quit = force_quit ? 1 : 0;
  return desired;
}

TEST(ForeignSheriff, DrivesOurDeputyThroughStartRestartStopAndRemoval) {
  LauncherWorld world;
  Inbox<procman_lcm::deputy_info_t> info(world.lcm, "PM_INFO");
  Inbox<procman_lcm::output_t> output(world.lcm, "PM_OUTPUT");
  const Command mapper = LauncherWorld::command("mapper");
  world.add_deputy({mapper});
  world.run(0.7);
  const auto order = [&](const std::vector<procman_lcm::cmd_desired_t>& commands) {
    procman_lcm::orders_t orders{};
    orders.utime = world.now.utime;
    orders.deputy_id = "d";
    orders.sheriff_id = "desk:4711:1700000000000000";
    orders.cmds = commands;
    orders.ncmds = static_cast<std::int32_t>(commands.size());
    world.lcm.publish("PM_ORDERS", &orders);
    world.pump();
    world.run(0.15);
  };
  order({order_for(mapper, 1, false)});
  ASSERT_EQ(info.last.ncmds, 1);
  EXPECT_EQ(info.last.cmds[0].pid, 101);
  EXPECT_EQ(info.last.cmds[0].actual_runid, 1);
  world.runner.printed.push_back({101, "hello"});
  order({order_for(mapper, 2, false)});
  EXPECT_EQ(info.last.cmds[0].pid, 102);
  EXPECT_EQ(info.last.cmds[0].actual_runid, 2);
  EXPECT_THAT(output.last.text, ::testing::Contains("hello"));
  order({order_for(mapper, 2, true)});
  EXPECT_EQ(info.last.cmds[0].pid, 0);
  EXPECT_EQ(info.last.cmds[0].exit_code, 2) << "raw wait status of SIGINT";
  order({});
  EXPECT_EQ(info.last.ncmds, 0);
}

TEST(ForeignDeputy, IsDrivenByOurSheriff) {
  LauncherWorld world;
  Inbox<procman_lcm::orders_t> orders(world.lcm, "PM_ORDERS");
  Inbox<procman_lcm::discovery_t> discovery(world.lcm, "PM_DISCOVER");
  PmdFile file;
  file.commands = {LauncherWorld::command("mapper")};
  file.commands[0].group = "services";
  Sheriff& sheriff = world.add_sheriff(file, "h:1:1");
  sheriff.start({});
  world.run(0.1);
  ASSERT_GE(discovery.count, 1);
  EXPECT_EQ(discovery.last.nonce, 0);
  EXPECT_EQ(orders.count, 0);

  procman_lcm::deputy_info_t info{};
  info.deputy_id = "d";
  const auto answer = [&] {
    info.utime = world.now.utime;
    info.ncmds = static_cast<std::int32_t>(info.cmds.size());
    world.lcm.publish("PM_INFO", &info);
    world.pump();
    world.run(0.05);
  };
  answer();
  ASSERT_THAT(orders.last.cmds, SizeIs(1));
  EXPECT_EQ(orders.last.deputy_id, "d");
  EXPECT_EQ(orders.last.cmds[0].desired_runid, 1);
  EXPECT_EQ(orders.last.cmds[0].force_quit, 0);
  EXPECT_EQ(orders.last.cmds[0].cmd.group, "services");

  info.cmds.resize(1);
  info.cmds[0].cmd = orders.last.cmds[0].cmd;
  info.cmds[0].pid = 77;
  info.cmds[0].actual_runid = 1;
  answer();
  world.say_ready("mapper");
  EXPECT_TRUE(sheriff.all_ready({}));

  sheriff.restart({});
  world.run(0.05);
  EXPECT_EQ(orders.last.cmds[0].desired_runid, 2);
  // procman's deputy stops at the first order and starts at the next
  info.cmds[0].pid = 0;
  info.cmds[0].exit_code = 2;
  answer();
  EXPECT_EQ(sheriff.states()[0].condition, Condition::kStarting);
  EXPECT_EQ(orders.last.cmds[0].force_quit, 0);
  info.cmds[0].pid = 78;
  info.cmds[0].actual_runid = 2;
  answer();
  sheriff.stop({});
  world.run(0.05);
  EXPECT_EQ(orders.last.cmds[0].force_quit, 1);
  EXPECT_EQ(orders.last.cmds[0].desired_runid, 2);
}

}  // namespace
}  // namespace luminav::launcher
