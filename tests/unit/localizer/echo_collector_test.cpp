#include "services/localizer/echo_collector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace luminav {
namespace {

/// A robot with four discs that hears something 1 m from each of them, wherever it is.
class ListeningRobot {
 public:
  ListeningRobot() : collector_(ring(), EchoRules{}) {}

  /// Drives straight to a place, and says how often it listened on the way.
  int drive_to(const Pose2& odom_from_robot) {
    int times = 0;
    const Pose2 start = place_;
    for (int i = 1; i <= kSteps; ++i) {
      const double share = static_cast<double>(i) / kSteps;
      const Pose2 next{start.x + share * (odom_from_robot.x - start.x), start.y + share * (odom_from_robot.y - start.y),
                       wrap_angle(start.theta + share * wrap_angle(odom_from_robot.theta - start.theta))};
      times += step(next).empty() ? 0 : 1;
    }
    return times;
  }
  EchoCollector& collector() { return collector_; }
  /// Stands at a place where the first disc hears something at `range`, and says what weight that has.
  double hear(const Pose2& odom_from_robot, double range) {
    range_ahead_ = range;
    const std::vector<PlacedEcho> echoes = step(odom_from_robot);
    range_ahead_ = 1.0;
    const auto ahead =
        std::find_if(echoes.begin(), echoes.end(), [](const PlacedEcho& echo) { return echo.end.x() > 1e-3; });
    return ahead == echoes.end() ? 0.0 : ahead->weight;
  }

 private:
  static constexpr int kSteps = 40;
  static SonarRing ring() {
    SonarRing ring;
    for (int disc = 0; disc < 4; ++disc) {
      ring.robot_from_sonar.push_back({0.0, 0.0, disc * 0.5 * kPi});
    }
    return ring;
  }
  std::vector<PlacedEcho> step(const Pose2& next) {
    utime_ += 100'000;
    OdometryReading reading;
    reading.utime = utime_;
    reading.session = 1;
    reading.odom_from_robot = next;
    history_.add(reading);
    collector_.advance(place_.inverse() * next);
    place_ = next;
    SonarScan scan;
    for (int disc = 0; disc < 4; ++disc) {
      scan.readings.push_back({disc, disc == 0 ? range_ahead_ : 1.0, true, utime_});
    }
    collector_.add(scan);
    return collector_.take(utime_, history_, 16);
  }

  EchoCollector collector_;
  OdometryHistory history_;
  Pose2 place_;
  double range_ahead_ = 1.0;  // [m]
  std::int64_t utime_ = 1'000'000;
};

TEST(EchoCollector, ListensAnewEveryStretchOfNewWay) {
  ListeningRobot robot;
  const int times = robot.drive_to({3.0, 0.0, 0.0});
  EXPECT_GE(times, 8);
  EXPECT_LE(times, 11);
}

TEST(EchoCollector, HearsNothingNewWhereItHasListenedBefore) {
  ListeningRobot robot;
  (void)robot.drive_to({3.0, 0.0, 0.0});
  for (int i = 0; i < 5; ++i) {
    EXPECT_LE(robot.drive_to({0.2, 0.0, 0.0}), 2);  // what the first way left out between two places
    EXPECT_LE(robot.drive_to({2.9, 0.0, 0.0}), 2);
  }
  int times = 0;
  for (int i = 0; i < 10; ++i) {
    times += robot.drive_to({2.9, 0.0, 0.0});
  }
  EXPECT_EQ(times, 0);
}

TEST(EchoCollector, CountsAThingOnceFromWhereverItIsHeard) {
  ListeningRobot robot;
  const Eigen::Vector2d thing(0.25, 0.25);
  double weight = 0.0;
  for (int i = 0; i < 24; ++i) {
    const double bearing = i * 2.0 * kPi / 24;
    const double range = 0.7 + 0.05 * i;
    weight += robot.hear(
        {thing.x() - range * std::cos(bearing), thing.y() - range * std::sin(bearing), wrap_angle(bearing)}, range);
  }
  EXPECT_NEAR(weight, 1.0, 1e-9);
  EXPECT_GT(robot.hear({5.0, 0.25, 0.0}, 1.2), 0.0) << "another thing is news";
}

TEST(EchoCollector, ListensAnewWhereverTheMotionWasLost) {
  ListeningRobot robot;
  (void)robot.drive_to({3.0, 0.0, 0.0});
  robot.collector().clear();
  EXPECT_GE(robot.drive_to({0.0, 0.0, 0.0}), 8);
}

TEST(EchoCollector, ListensAtOnceForWhoeverHasHeardNothing) {
  ListeningRobot robot;
  (void)robot.drive_to({3.0, 0.0, 0.0});
  ASSERT_EQ(robot.hear({3.0, 0.0, 0.0}, 1.0), 0.0);
  robot.collector().forget_places();
  EXPECT_GT(robot.hear({3.0, 0.0, 0.0}, 1.0), 0.0);
}

}  // namespace
}  // namespace luminav
