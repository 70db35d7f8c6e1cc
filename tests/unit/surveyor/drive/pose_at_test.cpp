#include "services/surveyor/drive/pose_at.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

/// A robot that drives along x at 1 m/s, its map turned by a quarter; odometry begins anew after 3 s.
class PoseAtTest : public testing::Test {
 protected:
  PoseAtTest() {
    for (int i = 0; i <= 6; ++i) {
      odometry_.push_back({1'000'000 * (i + 1), i > 3 ? 2 : 1, {static_cast<double>(i), 0.0, 0.0}, 1.0, 0.0});
    }
    frames_.resize(2);
    for (std::size_t f = 0; f < 2; ++f) {
      frames_[f].utime = odometry_[f + 1].utime;
      frames_[f].odom_from_robot = odometry_[f + 1].odom_from_robot;
    }
  }
  [[nodiscard]] std::optional<Pose2> at(double seconds) const {
    return pose_at(frames_, poses_, odometry_, static_cast<std::int64_t>(1e6 * seconds));
  }

  std::vector<OdometryReading> odometry_;
  std::vector<KeyFrame> frames_;
  std::vector<Pose2> poses_ = {{5.0, 1.0, 0.5 * kPi}, {5.0, 2.0, 0.5 * kPi}};
};

TEST_F(PoseAtTest, CarriesTheNearestKeyFrameByOdometry) {
  EXPECT_NEAR(at(2.0)->y, 1.0, 1e-9);
  EXPECT_NEAR(at(3.5)->y, 2.0, 1e-9);
  EXPECT_NEAR(at(4.0)->y, 3.0, 1e-9);
  EXPECT_NEAR(at(1.0)->y, 0.0, 1e-9) << "before the first key frame";
}

TEST_F(PoseAtTest, TheMapEndsAMetreBehindTheLastKeyFrame) {
  odometry_[3].odom_from_robot.x = 3.5;
  EXPECT_FALSE(at(4.0));
}

TEST_F(PoseAtTest, TheMapEndsWhereOdometryBeginsAnew) {
  odometry_[4].odom_from_robot.x = 2.0;  // as near as before, but in numbers that mean nothing
  EXPECT_FALSE(at(5.0));
}

TEST_F(PoseAtTest, ThereIsNoPoseWithoutAMap) {
  EXPECT_FALSE(pose_at({}, {}, odometry_, 2'000'000));
  EXPECT_FALSE(pose_at(frames_, poses_, {}, 2'000'000));
}

}  // namespace
}  // namespace luminav
