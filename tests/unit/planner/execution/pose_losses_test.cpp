#include "services/planner/execution/pose_losses.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(PoseLosses, AreBriefForASecondOnceThePoseWasKnown) {
  PoseLosses losses({});
  EXPECT_FALSE(losses.is_brief(1'000'000)) << "it has not been known for this goal";
  losses.track(1'000'000);
  EXPECT_TRUE(losses.is_brief(1'999'999));
  EXPECT_FALSE(losses.is_brief(2'000'000));
  losses.track(2'000'000);
  losses.begin();
  EXPECT_FALSE(losses.is_brief(2'000'000));
}

TEST(PoseLosses, CountFromZeroAgainAfterAMetreOfProgress) {
  GoalParams params;
  params.losses = 1;
  PoseLosses losses(params);
  EXPECT_TRUE(losses.count(10.0));
  EXPECT_TRUE(losses.count(8.9));
  EXPECT_FALSE(losses.count(8.5));
  losses.reset();
  EXPECT_FALSE(losses.has_lost());
  EXPECT_TRUE(losses.count(8.5));
}

}  // namespace
}  // namespace luminav
