#include "services/common/ceiling/odometry_history.hpp"

#include <gtest/gtest.h>

#include "services/localizer/model/frame_queue.hpp"

namespace luminav {
namespace {

OdometryReading reading(std::int64_t utime, double x, double theta = 0.0, std::int64_t session = 1) {
  return {utime, session, {x, 0.0, theta}, 0.0, 0.0};
}

TEST(OdometryHistory, InterpolatesBetweenReadings) {
  OdometryHistory history;
  history.add(reading(1'000'000, 1.0));
  history.add(reading(1'100'000, 2.0));
  const auto between = history.at(1'025'000);
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->odom_from_robot.x, 1.25, 1e-12);
}

TEST(OdometryHistory, InterpolatesHeadingAcrossPi) {
  OdometryHistory history;
  history.add(reading(0, 0.0, kPi - 0.1));
  history.add(reading(100, 0.0, -kPi + 0.1));
  EXPECT_NEAR(std::abs(history.at(50)->odom_from_robot.theta), kPi, 1e-9);
}

TEST(OdometryHistory, KnowsNothingOutsideOfWhatItKept) {
  OdometryHistory history;
  EXPECT_FALSE(history.at(0));
  history.add(reading(1000, 0.0));
  history.add(reading(2000, 0.0));
  EXPECT_FALSE(history.at(999));
  EXPECT_FALSE(history.at(2001));
}

TEST(OdometryHistory, DropsAllAtANewSession) {
  OdometryHistory history;
  history.add(reading(1000, 0.0));
  history.add(reading(2000, 5.0, 0.0, 2));
  EXPECT_FALSE(history.at(1500));
  EXPECT_TRUE(history.at(2000));
}

TEST(FrameQueue, HoldsAnImageUntilOdometryReachesIt) {
  FrameQueue queue;
  queue.add_odometry(reading(1000, 0.0));
  queue.add_frame({1500, {}});
  EXPECT_FALSE(queue.next());
  queue.add_odometry(reading(2000, 1.0));
  const auto timed = queue.next();
  ASSERT_TRUE(timed);
  EXPECT_NEAR(timed->odometry.odom_from_robot.x, 0.5, 1e-12);
}

TEST(FrameQueue, RefusesImagesOlderThanTheOdometryKeptAndRepeatedOnes) {
  FrameQueue queue;
  queue.add_odometry(reading(1000, 0.0));
  queue.add_odometry(reading(2000, 0.0));
  queue.add_frame({500, {}});
  EXPECT_FALSE(queue.next());
  queue.add_frame({1500, {}});
  EXPECT_TRUE(queue.next());
  queue.add_frame({1500, {}});
  EXPECT_FALSE(queue.next());
  EXPECT_EQ(queue.dropped(), 2);
}

}  // namespace
}  // namespace luminav
