#include <gtest/gtest.h>

#include <luminav_procman/procman_command_desired_t.hpp>
#include <luminav_procman/procman_command_status_t.hpp>
#include <luminav_procman/procman_command_t.hpp>
#include <luminav_procman/procman_deputy_info_t.hpp>
#include <luminav_procman/procman_discovery_t.hpp>
#include <luminav_procman/procman_orders_t.hpp>
#include <luminav_procman/procman_output_t.hpp>
#include <vector>

#include "services/launcher/exit_status.hpp"

namespace luminav::launcher {
namespace {

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

// The fingerprints of procman 3fc4a80 (2024), package procman_lcm.
TEST(Wire, HasProcmansFingerprints) {
  const auto fingerprint = [](auto message) { return static_cast<std::uint64_t>(decltype(message)::getHash()); };
  EXPECT_EQ(fingerprint(luminav_procman::procman_deputy_info_t{}), 0x8876aeb040efd01fULL);
  EXPECT_EQ(fingerprint(luminav_procman::procman_orders_t{}), 0xd343f45b171ab855ULL);
  EXPECT_EQ(fingerprint(luminav_procman::procman_output_t{}), 0x8efa5caf5da01eb3ULL);
  EXPECT_EQ(fingerprint(luminav_procman::procman_discovery_t{}), 0xb1c83182bed74b95ULL);
  EXPECT_EQ(fingerprint(luminav_procman::procman_command_t{}), 0x2277f449a855d330ULL);
  EXPECT_EQ(fingerprint(luminav_procman::procman_command_desired_t{}), 0xb2a6c7a09ba54539ULL);
  EXPECT_EQ(fingerprint(luminav_procman::procman_command_status_t{}), 0xa8e0208786cf86e3ULL);
}

TEST(Wire, LaysOutOrdersByteForByte) {
  luminav_procman::procman_orders_t orders{};
  orders.utime = 0x0102030405060708;
  orders.deputy_id = "d";
  orders.sheriff_id = "";
  orders.ncmds = 1;
  orders.cmds.resize(1);
  luminav_procman::procman_command_desired_t& command = orders.cmds[0];
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
  EXPECT_EQ(encoded(orders), expected);
}

TEST(Wire, LaysOutADeputysListByteForByte) {
  luminav_procman::procman_deputy_info_t info{};
  info.utime = 1;
  info.deputy_id = "d";
  info.cpu_load = 0.5F;
  info.phys_mem_total_bytes = 2;
  info.phys_mem_free_bytes = 3;
  info.swap_total_bytes = 4;
  info.swap_free_bytes = 5;
  info.ncmds = 1;
  info.cmds.resize(1);
  luminav_procman::procman_command_status_t& command = info.cmds[0];
  command.cmd.command_id = "c";
  command.cmd.exec_str = "x";
  command.cmd.group = "";
  command.cmd.auto_respawn = 1;
  command.cmd.stop_signal = 15;
  command.cmd.stop_time_allowed = 0.5F;
  command.pid = 0x01020304;
  command.actual_runid = 7;
  command.exit_code = 768;
  command.cpu_usage = 0.25F;
  command.mem_vsize_bytes = 0x0a0b0c0d0e;
  command.mem_rss_bytes = 9;
  const std::vector<std::uint8_t> expected = {
      0x88, 0x76, 0xae, 0xb0, 0x40, 0xef, 0xd0, 0x1f,  // fingerprint
      0,    0,    0,    0,    0,    0,    0,    1,     // utime
      0,    0,    0,    2,    'd',  0,                 // deputy_id
      0x3f, 0,    0,    0,                             // cpu_load
      0,    0,    0,    0,    0,    0,    0,    2,     // phys_mem_total_bytes
      0,    0,    0,    0,    0,    0,    0,    3,     // phys_mem_free_bytes
      0,    0,    0,    0,    0,    0,    0,    4,     // swap_total_bytes
      0,    0,    0,    0,    0,    0,    0,    5,     // swap_free_bytes
      0,    0,    0,    1,                             // ncmds
      0,    0,    0,    2,    'c',  0,                 // command_id
      0,    0,    0,    2,    'x',  0,                 // exec_str
      0,    0,    0,    1,    0,                       // group
      1,    15,   0x3f, 0,    0,    0,                 // auto_respawn, stop_signal, stop_time_allowed
      1,    2,    3,    4,                             // pid
      0,    0,    0,    7,                             // actual_runid
      0,    0,    3,    0,                             // exit_code
      0x3e, 0x80, 0,    0,                             // cpu_usage
      0,    0,    0,    0x0a, 0x0b, 0x0c, 0x0d, 0x0e,  // mem_vsize_bytes
      0,    0,    0,    0,    0,    0,    0,    9};    // mem_rss_bytes
  EXPECT_EQ(encoded(info), expected);
}

TEST(Wire, LaysOutOutputByteForByteItsCountInSixteenBits) {
  luminav_procman::procman_output_t output{};
  output.utime = 1;
  output.deputy_id = "d";
  output.num_commands = 2;
  output.command_ids = {"", "c"};
  output.text = {"t", "u\n"};
  const std::vector<std::uint8_t> expected = {0x8e, 0xfa, 0x5c, 0xaf, 0x5d, 0xa0, 0x1e, 0xb3,  // fingerprint
                                              0,    0,    0,    0,    0,    0,    0,    1,     // utime
                                              0,    0,    0,    2,    'd',  0,                 // deputy_id
                                              0,    2,                                         // num_commands
                                              0,    0,    0,    1,    0,    0,    0,    0,    2, 'c', 0,  // command_ids
                                              0,    0,    0,    2,    't',  0,    0,    0,    0, 3,   'u',
                                              '\n', 0};  // text
  EXPECT_EQ(encoded(output), expected);
}

TEST(Wire, LaysOutADiscoveryByteForByte) {
  luminav_procman::procman_discovery_t discovery{};
  discovery.utime = 1;
  discovery.transmitter_id = "d";
  discovery.nonce = 0x1234;
  const std::vector<std::uint8_t> expected = {0xb1, 0xc8, 0x31, 0x82, 0xbe, 0xd7, 0x4b, 0x95,   // fingerprint
                                              0,    0,    0,    0,    0,    0,    0,    1,      // utime
                                              0,    0,    0,    2,    'd',  0,                  // transmitter_id
                                              0,    0,    0,    0,    0,    0,    0x12, 0x34};  // nonce
  EXPECT_EQ(encoded(discovery), expected);
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
