#include "drivers/camera/simulated/truth.hpp"

#include <gtest/gtest.h>

namespace luminav::simulated {
namespace {

TruthSample sample(std::int64_t utime, const Pose2& pose, std::int64_t session = 1) {
  TruthSample result;
  result.utime = utime;
  result.session = session;
  result.world_from_robot = pose;
  return result;
}

TEST(TruthBuffer, InterpolatesBetweenTwoSamples) {
  TruthBuffer buffer;
  ASSERT_TRUE(buffer.add(sample(1000, {1.0, 2.0, 0.1})));
  ASSERT_TRUE(buffer.add(sample(2000, {1.1, 2.2, 0.3})));
  const auto pose = buffer.at(1250.0);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->world_from_robot.x, 1.025, 1e-12);
  EXPECT_NEAR(pose->world_from_robot.y, 2.05, 1e-12);
  EXPECT_NEAR(pose->world_from_robot.theta, 0.15, 1e-12);
}

TEST(TruthBuffer, TurnsTheShortWayRound) {
  TruthBuffer buffer;
  ASSERT_TRUE(buffer.add(sample(0, {0.0, 0.0, kPi - 0.1})));
  ASSERT_TRUE(buffer.add(sample(100, {0.0, 0.0, -kPi + 0.1})));
  EXPECT_NEAR(std::abs(buffer.at(50.0)->world_from_robot.theta), kPi, 1e-9);
}

TEST(TruthBuffer, KnowsNothingOutsideItsSamples) {
  TruthBuffer buffer;
  EXPECT_FALSE(buffer.at(0.0));
  ASSERT_TRUE(buffer.add(sample(1000, {})));
  EXPECT_TRUE(buffer.at(1000.0));
  EXPECT_FALSE(buffer.at(999.0));
  EXPECT_FALSE(buffer.at(1001.0));
}

TEST(TruthBuffer, ForgetsWhatIsOlderThanHalfASecond) {
  TruthBuffer buffer;
  for (std::int64_t utime = 0; utime <= 2'000'000; utime += 10'000) {
    ASSERT_TRUE(buffer.add(sample(utime, {})));
  }
  EXPECT_TRUE(buffer.at(1'600'000.0));
  EXPECT_FALSE(buffer.at(1'400'000.0));
}

TEST(TruthBuffer, RefusesOldSamplesAndStartsAnewWithANewSession) {
  TruthBuffer buffer;
  ASSERT_TRUE(buffer.add(sample(1000, {})));
  EXPECT_FALSE(buffer.add(sample(1000, {})));
  EXPECT_FALSE(buffer.add(sample(500, {})));
  EXPECT_TRUE(buffer.add(sample(500, {}, 2)));
  EXPECT_FALSE(buffer.at(1000.0));
}

TEST(TruthBuffer, AJumpIsNoFlight) {
  TruthBuffer buffer;
  ASSERT_TRUE(buffer.add(sample(0, {0.0, 0.0, 0.0})));
  ASSERT_TRUE(buffer.add(sample(100, {5.0, 0.0, 0.0})));
  EXPECT_EQ(buffer.at(40.0)->world_from_robot.x, 0.0);
  EXPECT_EQ(buffer.at(60.0)->world_from_robot.x, 5.0);
}

}  // namespace
}  // namespace luminav::simulated
