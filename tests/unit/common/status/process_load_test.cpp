#include "services/common/process/status/process_load.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(ProcessLoad, SaysTheLongestStepSinceTheLastReport) {
  ProcessLoad load;
  const auto work = [] {
    for (const std::int64_t start = read_clock(CLOCK_MONOTONIC); read_clock(CLOCK_MONOTONIC) < start + 2'000;) {
    }
  };
  load.measure(work);
  load.measure([] {});
  node_status_t status{};
  load.report(status);
  EXPECT_GE(status.worst_step_us, 2'000);
  EXPECT_GT(status.memory_bytes, 100'000);
  EXPECT_EQ(status.cpu_fraction, 0.0) << "of no time yet";
  load.report(status);
  EXPECT_EQ(status.worst_step_us, 0);
}

}  // namespace
}  // namespace luminav
