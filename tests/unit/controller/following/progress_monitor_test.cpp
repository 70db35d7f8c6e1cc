#include "services/controller/following/progress_monitor.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(ProgressMonitor, CountsWhileNothingMoves) {
  ProgressMonitor monitor;
  monitor.restart(1'000'000, {});
  EXPECT_DOUBLE_EQ(monitor.update(4'000'000, {0.1, 0.0, 0.1}), 3.0);
}

TEST(ProgressMonitor, StartsAnewAfterTwentyCentimetres) {
  ProgressMonitor monitor;
  monitor.restart(1'000'000, {});
  EXPECT_DOUBLE_EQ(monitor.update(4'000'000, {0.21, 0.0, 0.0}), 0.0);
}

TEST(ProgressMonitor, TurningIsProgressUntilItIsSpinning) {
  ProgressMonitor monitor;
  monitor.restart(1'000'000, {});
  std::int64_t now = 1'000'000;
  double heading = 0.0;
  for (int i = 0; i < 14; ++i) {
    heading += radians(50.0);
    now += 1'000'000;
    EXPECT_LT(monitor.update(now, {0.0, 0.0, wrap_angle(heading)}), 0.5);
  }
  double longest = 0.0;
  for (int i = 0; i < 10; ++i) {
    heading += radians(50.0);
    now += 1'000'000;
    longest = monitor.update(now, {0.0, 0.0, wrap_angle(heading)});
  }
  EXPECT_GT(longest, 5.0);
}

TEST(ProgressMonitor, BearsAClockThatGoesBack) {
  ProgressMonitor monitor;
  monitor.restart(9'000'000, {});
  EXPECT_DOUBLE_EQ(monitor.update(1'000'000, {}), 0.0);
}

}  // namespace
}  // namespace luminav
