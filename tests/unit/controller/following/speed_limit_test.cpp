#include "services/controller/following/speed_limit.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;
constexpr std::int64_t kSecond = 1'000'000;

TEST(SpeedLimit, HoldsForASecondOfStamps) {
  HeldSpeedLimit limit;
  EXPECT_FALSE(limit.at(kNow));
  EXPECT_TRUE(limit.take({kNow, 0.3, "jobs"}, kNow));
  EXPECT_EQ(limit.at(kNow + kSecond)->max_speed, 0.3);
  EXPECT_FALSE(limit.at(kNow + kSecond + 1));
  EXPECT_FALSE(limit.at(kNow - 2 * kSecond)) << "a clock that went back";
}

TEST(SpeedLimit, IsRaisedByItsOwnSenderAlone) {
  HeldSpeedLimit limit;
  limit.take({kNow, 0.2, "jobs"}, kNow);
  limit.take({kNow, 0.4, "other"}, kNow);
  EXPECT_EQ(limit.at(kNow)->max_speed, 0.2);
  limit.take({kNow, 0.3, "jobs"}, kNow);
  EXPECT_EQ(limit.at(kNow)->max_speed, 0.3);
  limit.take({kNow, 0.1, "other"}, kNow);
  EXPECT_EQ(limit.at(kNow)->sender, "other");
  const std::int64_t later = kNow + 2 * kSecond;
  limit.take({later, 0.4, "jobs"}, later);
  EXPECT_EQ(limit.at(later)->max_speed, 0.4) << "who fell silent is forgotten";
}

TEST(SpeedLimit, IsNoneThatNobodyDrivesBy) {
  HeldSpeedLimit limit;
  for (const double speed :
       {0.0, -0.3, 0.04, 5.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(limit.take({kNow, speed, "jobs"}, kNow)) << speed;
  }
  EXPECT_FALSE(limit.take({kNow - 2 * kSecond, 0.3, "jobs"}, kNow)) << "a backlog";
  EXPECT_FALSE(limit.take({kNow + 2 * kSecond, 0.3, "jobs"}, kNow)) << "it would never grow old";
  EXPECT_FALSE(limit.at(kNow));
}

}  // namespace
}  // namespace luminav
