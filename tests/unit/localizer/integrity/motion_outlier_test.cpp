#include "services/localizer/integrity/motion_outlier.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace luminav {
namespace {

constexpr double kPeriod = 1.0 / 15.0;  // [s] between images
constexpr double kSpeed = 1.0;          // [m/s] of what rushes

/// A robot before which things go their ways, image by image.
class Watcher {
 public:
  /// The next image shows things there [robot frame]; the wheels have turned by `wheels` since the one before.
  bool see(const std::vector<Pose2>& things, const Pose2& wheels = {}) {
    SightingFrame frame;
    frame.utime = utime_ += static_cast<std::int64_t>(1e6 * kPeriod);
    odom_ = odom_ * wheels;
    for (const Pose2& thing : things) {
      FixtureSighting sighting;
      sighting.robot_from_fixture = thing;
      sighting.covariance = 1e-6 * Eigen::Matrix3d::Identity();
      frame.sightings.push_back(sighting);
    }
    return watch_.look(frame, odom_);
  }
  MotionOutlier& watch() { return watch_; }

 private:
  MotionOutlier watch_{0.33};
  Pose2 odom_;
  std::int64_t utime_ = 1'000'000'000;
};

Pose2 rushing(int image, double speed = kSpeed) {
  return {1.2 - image * kPeriod * speed, 0.5, 0.2};
}

TEST(MotionOutlier, TellsByThreeImagesThatAThingRushesPast) {
  Watcher watcher;
  EXPECT_FALSE(watcher.see({rushing(0)}));
  EXPECT_FALSE(watcher.see({rushing(1)}));
  EXPECT_TRUE(watcher.see({rushing(2)}));
  EXPECT_TRUE(watcher.see({rushing(3)}));
  EXPECT_FALSE(watcher.see({rushing(3)}));
}

TEST(MotionOutlier, TellsItWhileTheWheelsTurn) {
  Watcher watcher;
  bool is_told = false;
  for (int i = 0; i < 3; ++i) {
    is_told = watcher.see({{0.3 + i * kPeriod * kSpeed, 0.2, 0.2}}, {0.5 * kPeriod, 0.0, 0.0});
  }
  EXPECT_TRUE(is_told);
}

TEST(MotionOutlier, IsCalmUnderWhatTheWheelsExplain) {
  for (const double grip : {1.0, 0.5, 0.0}) {
    Watcher watcher;
    for (int i = 0; i < 8; ++i) {
      EXPECT_FALSE(watcher.see({rushing(i, 0.9 * grip)}, {0.9 * kPeriod, 0.0, 0.0})) << grip;
    }
  }
  Watcher turning;
  const Pose2 step{0.0, 0.0, 0.06};
  Pose2 robot_from_thing{1.2, 0.5, 0.0};
  for (int i = 0; i < 8; ++i) {
    robot_from_thing = step.inverse() * robot_from_thing;
    EXPECT_FALSE(turning.see({robot_from_thing}, step));
  }
}

TEST(MotionOutlier, IsCalmUnderWhatJumpsOrCreeps) {
  Watcher jumping;
  for (const double x : {1.0, 1.0, 0.7, 0.7, 1.0, 0.7, 0.9}) {
    EXPECT_FALSE(jumping.see({{x, 0.0, 0.0}}));
  }
  Watcher creeping;
  for (int i = 0; i < 8; ++i) {
    EXPECT_FALSE(creeping.see({rushing(i, 0.3)}));
  }
}

TEST(MotionOutlier, DoesNotBelieveOneThingAgainstAnotherThatStays) {
  Watcher watcher;
  for (int i = 0; i < 6; ++i) {
    EXPECT_FALSE(watcher.see({rushing(i), {-0.5, -0.3, 0.0}}));
  }
}

TEST(MotionOutlier, ForgetsWhatWasBeforeAGap) {
  Watcher watcher;
  watcher.see({rushing(0)});
  watcher.see({rushing(1)});
  watcher.watch().clear();
  EXPECT_FALSE(watcher.see({rushing(2)}));
}

}  // namespace
}  // namespace luminav
