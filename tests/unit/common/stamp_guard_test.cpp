#include "services/common/process/stamp_guard.hpp"

#include <gtest/gtest.h>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

using Verdict = StampGuard::Verdict;

TEST(StampGuard, RefusesWhatIsNotNewer) {
  StampGuard guard;
  EXPECT_EQ(guard.check(10'000'000), Verdict::kNewer);
  EXPECT_EQ(guard.check(10'000'000), Verdict::kOld);
  EXPECT_EQ(guard.check(9'500'000), Verdict::kOld);
  EXPECT_EQ(guard.check(10'000'001), Verdict::kNewer);
}

TEST(StampGuard, TakesThreeBackwardJumpsInARowForANewSession) {
  StampGuard guard;
  EXPECT_EQ(guard.check(100'000'000), Verdict::kNewer);
  EXPECT_EQ(guard.check(5'000'000), Verdict::kOld);
  EXPECT_EQ(guard.check(5'100'000), Verdict::kOld);
  EXPECT_EQ(guard.check(5'200'000), Verdict::kNewSession);
  EXPECT_EQ(guard.check(5'300'000), Verdict::kNewer);
}

TEST(StampGuard, IsNotFooledBySingleStrays) {
  StampGuard guard;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(guard.check(100'000'000 + i), Verdict::kNewer);
    EXPECT_EQ(guard.check(5'000'000), Verdict::kOld);
  }
}

TEST(Seconds, ComeFromStampsAndGoBack) {
  EXPECT_EQ(seconds_of(1'500'000), 1.5);
  EXPECT_EQ(seconds_between(2'000'000, 1'000'000), -1.0);
  EXPECT_EQ(microseconds_of(0.25), 250'000);
  EXPECT_EQ(microseconds_of(1e-7), 0);
}

}  // namespace
}  // namespace luminav
