#include "services/localizer/hypotheses/echo_collector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace luminav {
namespace {

/// A robot with four discs that hears something 1 m from each of them, wherever it is.
class ListeningRobot {
 public:
  ListeningRobot() : collector_(ring(), HypothesisParams{}) {}

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
  /// Stands at a place where the first disc hears nothing, and says what weight that has as passage.
  double hear_nothing(const Pose2& odom_from_robot) {
    is_silent_ahead_ = true;
    const std::vector<PlacedEcho> echoes = step(odom_from_robot);
    is_silent_ahead_ = false;
    const auto silent =
        std::find_if(echoes.begin(), echoes.end(), [](const PlacedEcho& echo) { return echo.weight == 0.0; });
    return silent == echoes.end() || silent->range < 3.0 ? 0.0 : silent->passage_weight;
  }
  /// Drives straight to a place, its first disc hearing nothing on the first third, and returns what was collected.
  std::vector<PlacedEcho> pass_a_gap_to(const Pose2& odom_from_robot) {
    std::vector<PlacedEcho> echoes;
    const Pose2 start = place_;
    constexpr int kShort = 6;
    for (int i = 1; i <= kShort; ++i) {
      const double share = static_cast<double>(i) / kShort;
      is_silent_ahead_ = i <= kShort / 3;
      const std::vector<PlacedEcho> taken = step({start.x + share * (odom_from_robot.x - start.x),
                                                  start.y + share * (odom_from_robot.y - start.y), start.theta});
      echoes.insert(echoes.end(), taken.begin(), taken.end());
    }
    is_silent_ahead_ = false;
    return echoes;
  }
  /// Stands there for so long [s] without scans.
  void wait(double seconds) { utime_ += static_cast<std::int64_t>(1e6 * seconds); }

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
      const bool is_silent = disc == 0 && is_silent_ahead_;
      scan.readings.push_back({disc, is_silent ? 5.0 : disc == 0 ? range_ahead_ : 1.0, !is_silent, utime_});
    }
    collector_.add(scan);
    return collector_.take(utime_, history_, 16);
  }

  EchoCollector collector_;
  OdometryHistory history_;
  Pose2 place_;
  double range_ahead_ = 1.0;  // [m]
  bool is_silent_ahead_ = false;
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

TEST(EchoCollector, CountsSilenceTwiceForAPassage) {
  ListeningRobot robot;
  ASSERT_GT(robot.hear({0.2, 0.2, 0.0}, 1.0), 0.0);
  // three places from which the beam passes the same square 1 m ahead
  EXPECT_NEAR(robot.hear_nothing({2.1, 0.1, 0.05}), 0.5, 1e-9);
  EXPECT_NEAR(robot.hear_nothing({2.1, 0.4, 0.05}), 0.5, 1e-9);
  EXPECT_NEAR(robot.hear_nothing({2.45, 0.2, 0.05}), 0.0, 1e-9);
}

TEST(EchoCollector, KeepsTheSilenceOfADoorwayThatItPassesBetweenTwoCollections) {
  ListeningRobot robot;
  ASSERT_GT(robot.hear({-3.0, 0.0, kPi / 2}, 1.0), 0.0);
  ASSERT_GT(robot.hear({-0.05, -2.0, kPi / 2}, 1.0), 0.0);
  // the first disc looks sideways: when the next collection is due it hears the wall again
  const std::vector<PlacedEcho> echoes = robot.pass_a_gap_to({0.28, -2.0, kPi / 2});
  const auto is_passage = [](const PlacedEcho& echo) { return echo.weight == 0.0 && echo.range > 3.0; };
  EXPECT_EQ(std::count_if(echoes.begin(), echoes.end(), is_passage), 2);
  for (const PlacedEcho& echo : echoes) {
    EXPECT_TRUE(!is_passage(echo) || (echo.passage_weight == 0.5 && echo.disc.y() > 0.1))
        << "twice for the doorway, and from where it was beside it";
  }
  EXPECT_TRUE(std::any_of(echoes.begin(), echoes.end(), [](const PlacedEcho& echo) { return echo.weight > 0.0; }));
}

TEST(EchoCollector, BelievesNoSilenceOfADiscThatMayBeDead) {
  ListeningRobot robot;
  EXPECT_EQ(robot.hear_nothing({0.0, 0.0, 0.0}), 0.0) << "it never heard anything";
  ASSERT_GT(robot.hear({1.0, 0.0, 0.0}, 1.0), 0.0);
  EXPECT_GT(robot.hear_nothing({2.0, 0.0, 0.0}), 0.0);
  robot.wait(30.0);
  EXPECT_EQ(robot.hear_nothing({3.0, 0.0, 0.0}), 0.0) << "nor in the last half minute";
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
  robot.collector().begin_for(0);
  ASSERT_EQ(robot.hear({3.0, 0.0, 0.0}, 1.0), 0.0);
  robot.collector().begin_for(1);
  EXPECT_GT(robot.hear({3.0, 0.0, 0.0}, 1.0), 0.0);
}

}  // namespace
}  // namespace luminav
