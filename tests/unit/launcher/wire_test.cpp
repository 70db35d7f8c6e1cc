#include <gtest/gtest.h>

#include <procman/procman_command_desired_t.hpp>
#include <procman/procman_command_status_t.hpp>
#include <procman/procman_command_t.hpp>
#include <procman/procman_deputy_info_t.hpp>
#include <procman/procman_discovery_t.hpp>
#include <procman/procman_orders_t.hpp>
#include <procman/procman_output_t.hpp>
#include <vector>

#include "services/launcher/exit_status.hpp"

namespace luminav::launcher {
namespace {

// The fingerprints of procman 3fc4a80 (2024), package procman_lcm.
TEST(Wire, HasProcmansFingerprints) {
  const auto fingerprint = [](auto message) { return static_cast<std::uint64_t>(decltype(message)::getHash()); };
  EXPECT_EQ(fingerprint(procman::procman_deputy_info_t{}), 0x8876aeb040efd01fULL);
  EXPECT_EQ(fingerprint(procman::procman_orders_t{}), 0xd343f45b171ab855ULL);
  EXPECT_EQ(fingerprint(procman::procman_output_t{}), 0x8efa5caf5da01eb3ULL);
  EXPECT_EQ(fingerprint(procman::procman_discovery_t{}), 0xb1c83182bed74b95ULL);
  EXPECT_EQ(fingerprint(procman::procman_command_t{}), 0x2277f449a855d330ULL);
  EXPECT_EQ(fingerprint(procman::procman_command_desired_t{}), 0xb2a6c7a09ba54539ULL);
  EXPECT_EQ(fingerprint(procman::procman_command_status_t{}), 0xa8e0208786cf86e3ULL);
}

TEST(Wire, LaysOutOrdersByteForByte) {
  procman::procman_orders_t orders{};
  orders.utime = 0x0102030405060708;
  orders.deputy_id = "d";
  orders.sheriff_id = "";
  orders.ncmds = 1;
  orders.cmds.resize(1);
  procman::procman_command_desired_t& command = orders.cmds[0];
  command.cmd.command_id = "c";
  command.cmd.exec_str = "x y";
  command.cmd.group = "g";
  command.cmd.auto_respawn = 1;
  command.cmd.stop_signal = 2;
  command.cmd.stop_time_allowed = 7.0F;
  command.desired_runid = 5;
  command.force_quit = 1;
  const std::vector<std::uint8_t> expected = {
      0xd3, 0x43, 0xf4, 0x5b, 0x17, 0x1a, 0xb8, 0x55,  // fingerprint
      1,    2,    3,    4,    5,    6,    7,    8,     // utime
      0,    0,    0,    2,    'd',  0,                 // deputy_id
      0,    0,    0,    1,    0,                       // sheriff_id
      0,    0,    0,    1,                             // ncmds
      0,    0,    0,    2,    'c',  0,                 // command_id
      0,    0,    0,    4,    'x',  ' ',  'y',  0,     // exec_str
      0,    0,    0,    2,    'g',  0,                 // group
      1,    2,    0x40, 0xe0, 0,    0,                 // auto_respawn, stop_signal, stop_time_allowed
      0,    0,    0,    5,    1};                      // desired_runid, force_quit
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(orders.getEncodedSize()));
  ASSERT_EQ(orders.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(expected.size()));
  EXPECT_EQ(bytes, expected);
}

TEST(Wire, CountsOutputInSixteenBits) {
  procman::procman_output_t output{};
  output.num_commands = 1;
  output.command_ids = {""};
  output.text = {"t"};
  // 8 fingerprint, 8 utime, 5 deputy_id, 2 count, 5 id, 6 text
  EXPECT_EQ(output.getEncodedSize(), 34);
}

TEST(ExitStatus, ReadsRawWaitStatus) {
  EXPECT_EQ(describe_exit(768), "exit 3");
  EXPECT_EQ(describe_exit(2), "killed by SIGINT");
  EXPECT_EQ(describe_exit(9), "killed by SIGKILL");
  EXPECT_EQ(describe_exit(kGaveUpStatus), "gave up restarting it");
  EXPECT_EQ(describe_exit(kRefusedStatus), "refused");
  EXPECT_TRUE(ended_well(0));
  EXPECT_FALSE(ended_well(2));
  EXPECT_TRUE(ended_by_signal(15, 15));
  EXPECT_FALSE(ended_by_signal(15 << 8, 15));
}

}  // namespace
}  // namespace luminav::launcher
