#include "services/mapper/pose_history.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

PoseHistory::Entry entry(std::int64_t utime, double x, bool trusted = true, double theta = 0.0) {
  return {utime, {x, 0.0, theta}, 0.5, trusted};
}

TEST(PoseHistory, InterpolatesBetweenTwoPoses) {
  PoseHistory history;
  history.add(entry(1'000'000, 1.0));
  history.add(entry(1'100'000, 1.05));
  const auto pose = history.trusted_at(1'040'000);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x, 1.02, 1e-9);
}

TEST(PoseHistory, TurnsTheShorterWay) {
  PoseHistory history;
  history.add(entry(1'000'000, 1.0, true, kPi - 0.02));
  history.add(entry(1'100'000, 1.0, true, -kPi + 0.02));
  EXPECT_NEAR(std::abs(history.trusted_at(1'050'000)->theta), kPi, 1e-9);
}

TEST(PoseHistory, KnowsNothingOutsideItsTime) {
  PoseHistory history;
  EXPECT_FALSE(history.trusted_at(1));
  history.add(entry(1'000'000, 1.0));
  history.add(entry(1'100'000, 1.05));
  EXPECT_FALSE(history.trusted_at(999'999));
  EXPECT_FALSE(history.trusted_at(1'100'001));
  EXPECT_TRUE(history.trusted_at(1'100'000));
}

TEST(PoseHistory, TrustsNoPoseBetweenAGoodAndABadOne) {
  PoseHistory history;
  history.add(entry(1'000'000, 1.0));
  history.add(entry(1'100'000, 1.05, false));
  history.add(entry(1'200'000, 1.10));
  EXPECT_FALSE(history.trusted_at(1'050'000));
  EXPECT_FALSE(history.trusted_at(1'150'000));
  EXPECT_FALSE(history.trusted_at(1'100'000));
  EXPECT_TRUE(history.trusted_at(1'200'000));
}

TEST(PoseHistory, DoesNotInterpolateOverAJump) {
  PoseHistory history;
  history.add(entry(1'000'000, 1.0));
  history.add(entry(1'100'000, 3.0));
  EXPECT_FALSE(history.trusted_at(1'050'000));
}

TEST(PoseHistory, DoesNotInterpolateOverAGap) {
  PoseHistory history;
  history.add(entry(1'000'000, 1.0));
  history.add(entry(1'900'000, 1.2));
  EXPECT_FALSE(history.trusted_at(1'500'000));
}

}  // namespace
}  // namespace luminav
