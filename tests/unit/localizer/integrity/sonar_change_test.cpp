// By the sonars: whether somebody carries a robot whose wheels stand still.

#include "services/localizer/integrity/sonar_change.hpp"

#include <gtest/gtest.h>

#include <array>

namespace luminav {
namespace {

constexpr int kDiscs = 16;
constexpr double kSilence = 5.0;  // [m] no echo

/// A ring of discs, all of which fire once a scan.
class Ring {
 public:
  Ring() { ranges_.fill(2.0); }

  /// Hears this for a while; returns whether it was carried.
  bool hear(double time, const Pose2& velocity = {}) {
    bool is_kidnapped = false;
    for (int i = 0; i < static_cast<int>(time / 0.1); ++i) {
      utime_ += 100'000;
      odom_ = odom_ * Pose2{0.1 * velocity.x, 0.1 * velocity.y, 0.1 * velocity.theta};
      SonarScan scan{utime_, {}};
      for (int disc = 0; disc < kDiscs; ++disc) {
        const double range = ranges_[static_cast<std::size_t>(disc)];
        scan.readings.push_back({disc, range, range < kSilence, utime_});
      }
      is_kidnapped = watch_.look(scan, odom_) || is_kidnapped;
    }
    return is_kidnapped;
  }
  /// Discs from first to last hear something farther by this [m].
  void move(int first, int last, double farther) {
    for (int disc = first; disc <= last; ++disc) {
      ranges_[static_cast<std::size_t>(disc)] += farther;
    }
  }

 private:
  SonarChange watch_;
  std::array<double, kDiscs> ranges_{};
  Pose2 odom_;
  std::int64_t utime_ = 1'000'000'000;
};

TEST(SonarChange, HearsThatItIsCarried) {
  Ring ring;
  ASSERT_FALSE(ring.hear(1.0));
  ring.move(0, 12, 0.15);
  EXPECT_TRUE(ring.hear(0.1));
  EXPECT_FALSE(ring.hear(1.0)) << "that is over";
}

TEST(SonarChange, HearsItWhereSomeEchoesComeAndGo) {
  Ring ring;
  ring.move(12, 15, kSilence);
  ASSERT_FALSE(ring.hear(1.0));
  ring.move(0, 6, -0.2);
  EXPECT_FALSE(ring.hear(0.5)) << "of twelve that go on to hear something seven are too few";
  ring.move(7, 10, kSilence);
  EXPECT_TRUE(ring.hear(0.1));
}

TEST(SonarChange, TakesPassersByForWhatTheyAre) {
  Ring ring;
  ASSERT_FALSE(ring.hear(1.0));
  for (int disc = 0; disc < kDiscs - 3; ++disc) {
    ring.move(disc, disc + 3, -1.2);
    EXPECT_FALSE(ring.hear(0.3));
    ring.move(disc, disc + 3, 1.2);
  }
}

TEST(SonarChange, TellsNothingWhileTheWheelsTurn) {
  Ring ring;
  ASSERT_FALSE(ring.hear(1.0));
  for (int i = 0; i < 10; ++i) {
    ring.move(0, kDiscs - 1, -0.04);
    EXPECT_FALSE(ring.hear(0.1, {0.4, 0.0, 0.0}));
  }
}

TEST(SonarChange, ForgetsWhatChangedLittleByLittle) {
  Ring ring;
  ASSERT_FALSE(ring.hear(1.0));
  for (int disc = 0; disc < kDiscs; ++disc) {
    ring.move(disc, disc, 0.5);
    EXPECT_FALSE(ring.hear(2.0));
  }
}

}  // namespace
}  // namespace luminav
