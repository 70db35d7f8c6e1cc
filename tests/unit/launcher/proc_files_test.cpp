#include "services/launcher/deputy/processes/proc_files.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace luminav::launcher {
namespace {

TEST(ProcessStat, ReadsAroundBlanksAndBracketsInTheName) {
  const auto stat = parse_process_stat(
      "42 (a ) (b c) S 7 41 40 34816 42 4194304 100 0 0 0 250 50 0 0 20 0 3 0 12345 1048576 25 18446744073709551615");
  ASSERT_TRUE(stat.has_value());
  EXPECT_EQ(stat->state, 'S');
  EXPECT_EQ(stat->parent, 7);
  EXPECT_EQ(stat->session, 40);
  EXPECT_EQ(stat->cpu, 300 * 1'000'000 / sysconf(_SC_CLK_TCK));
  EXPECT_EQ(stat->virtual_bytes, 1048576);
  EXPECT_EQ(stat->resident_bytes, 25 * sysconf(_SC_PAGESIZE));
}

TEST(ProcessStat, RefusesWhatIsCutOff) {
  EXPECT_FALSE(parse_process_stat("").has_value());
  EXPECT_FALSE(parse_process_stat("42 (name) S 7 41").has_value());
}

TEST(ProcessStat, KnowsThisProcess) {
  const auto stat = read_process_stat(getpid());
  ASSERT_TRUE(stat.has_value());
  EXPECT_EQ(stat->parent, getppid());
  EXPECT_GT(stat->resident_bytes, 0);
  EXPECT_FALSE(read_process_stat(0x7fffffff).has_value());
}

TEST(MachineUsage, IsPlausible) {
  const MachineUsage usage = read_machine_usage();
  EXPECT_GT(usage.memory_total, usage.memory_free);
  EXPECT_GE(usage.cpu_total, usage.cpu_busy);
  EXPECT_GT(usage.cpu_total, 0);
}

}  // namespace
}  // namespace luminav::launcher
