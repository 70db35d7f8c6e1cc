#include "drivers/base/line/retry_schedule.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

/// [us] from a failure until the line is tried again.
std::int64_t delay_after(RetrySchedule& retry, std::int64_t now) {
  retry.fail(now);
  std::int64_t delay = 0;
  while (!retry.is_due(now + delay)) {
    delay += 10'000;
  }
  return delay;
}

TEST(RetrySchedule, TriesSoonAtFirstThenWithDelaysThatDouble) {
  RetrySchedule retry;
  EXPECT_TRUE(retry.is_due(0));
  for (int i = 0; i < 21; ++i) {
    EXPECT_EQ(delay_after(retry, 1'000'000), 50'000);
  }
  EXPECT_EQ(delay_after(retry, 1'000'000), 100'000);
  for (int i = 0; i < 100; ++i) {
    EXPECT_LE(delay_after(retry, 1'000'000), RetrySchedule::kLongest);
  }
  EXPECT_EQ(delay_after(retry, 1'000'000), RetrySchedule::kLongest);
  retry.succeed();
  EXPECT_EQ(delay_after(retry, 1'000'000), 50'000);
}

TEST(RetrySchedule, WaitsAsLongAsItIsTold) {
  RetrySchedule retry;
  retry.fail(0);
  retry.wait_until(3'000'000);
  EXPECT_FALSE(retry.is_due(2'999'999));
  EXPECT_TRUE(retry.is_due(3'000'000));
}

}  // namespace
}  // namespace luminav
