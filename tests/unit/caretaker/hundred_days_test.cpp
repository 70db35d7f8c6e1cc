#include "tests/unit/caretaker/hundred_days.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(HundredDays, ReportsFailuresWithinThreePassesAndHardlyAnythingElse) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const HundredDays outcome = simulate_hundred_days(seed);
    EXPECT_GE(outcome.failures, 3) << seed;
    EXPECT_EQ(outcome.late, 0) << seed;
    EXPECT_LE(outcome.false_reports.size(), 1U) << seed;
    EXPECT_EQ(outcome.changes, 0) << seed;
  }
}

}  // namespace
}  // namespace luminav
