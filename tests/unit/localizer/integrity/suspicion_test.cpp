// What puts a tracked pose in doubt in a corridor where every fixture looks like the next one, and how it comes back.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "services/localizer/modern_localizer.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

constexpr double kPitch = 3.0;   // [m] fixtures at 1.5, 4.5, 7.5, ...
constexpr double kMiddle = 1.2;  // [m] of the corridor
constexpr double kWall = 1.0;    // [m] on either side of it
constexpr double kDisc = 0.2;    // [m] of a sonar from the robot's middle
constexpr double kSpeed = 0.4;   // [m/s]

RobotDescription robot() {
  RobotDescription robot;
  robot.camera.mounting.z = 0.3;
  for (const double ahead : {-0.1, 0.0, 0.1}) {
    robot.sonar.robot_from_sonar.push_back({ahead, kDisc, 0.5 * kPi});
    robot.sonar.robot_from_sonar.push_back({ahead, -kDisc, -0.5 * kPi});
  }
  return robot;
}

/// Drives along the corridor's middle with odometry and pictures that are exact.
class CorridorDrive {
 public:
  /// With one more fixture at `extra`, if given.
  explicit CorridorDrive(std::optional<double> extra = {}, const TrackingRules& rules = {})
      : corridor_(corridor(extra)),
        localizer_(corridor_.building, corridor_.walls, robot(), ErrorParams{}, {{}, rules}) {
    localizer_.recall({{x_, kMiddle, 0.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()});
  }

  /// Drives on to a place; returns the reasons of all states that were not TRACKING on the way.
  std::vector<std::string> drive_to(double x) {
    std::vector<std::string> reasons;
    while (std::abs(x - x_) > 0.5 * kSpeed * 0.1) {
      const double linear = x > x_ ? kSpeed : -kSpeed;
      move(linear, 0.1);
      localizer_.add_odometry({utime_, session_, {odom_, 0.0, 0.0}, linear, 0.0});
      if (hears_walls_) {
        SonarScan scan{utime_, {}};
        for (int disc = 0; disc < static_cast<int>(robot().sonar.robot_from_sonar.size()); ++disc) {
          scan.readings.push_back({disc, kWall - kDisc, true, utime_});
        }
        localizer_.add_sonar(scan);
      }
      localizer_.add_frame({utime_, look()});
      if (state() != LocalizerState::kTracking) {
        reasons.push_back(localizer_.estimate().reason);
      }
    }
    return reasons;
  }
  /// Odometry ends, the robot drives on for a while and stands; then odometry begins anew.
  void lose_odometry(double driving, double silent) {
    move(kSpeed, driving);
    utime_ += static_cast<std::int64_t>(1e6 * (silent - driving));
    odom_ = 0.0;
    ++session_;
  }
  void kidnap_to(double x) { x_ = x; }
  /// Pushes it there while its wheels stand still; returns whether it was doubted on the way.
  bool push_to(double x, double speed = 0.5) {
    bool is_suspected = false;
    while (std::abs(x - x_) > 0.05 * speed) {
      x_ += (x > x_ ? 0.1 : -0.1) * speed;
      is_suspected = !stand(0.1) || is_suspected;
    }
    return is_suspected;
  }
  /// The wheels turn on, without an image of it.
  void roll_on(double distance) { move(kSpeed, distance / kSpeed); }
  /// Stands for a while; returns whether it was held for true all the time.
  bool stand(double time) {
    bool is_tracking = true;
    for (int i = 0; i < static_cast<int>(time / 0.1); ++i) {
      move(0.0, 0.1);
      localizer_.add_odometry({utime_, session_, {odom_, 0.0, 0.0}, 0.0, 0.0});
      localizer_.add_frame({utime_, look()});
      is_tracking = is_tracking && state() == LocalizerState::kTracking;
    }
    return is_tracking;
  }
  /// How far [m] along the corridor fixtures are seen.
  void see_as_far_as(double reach) { reach_ = reach; }
  void hear_walls() { hears_walls_ = true; }
  /// From now on the fixtures are seen so far to the left of their places [m], and turned so much [rad].
  void hang_all_beside(double left, double turn) {
    left_ = left;
    turn_ = turn;
  }
  void hang_false_fixture(double x) { false_fixtures_.push_back(x); }
  void take_down_false_fixtures() { false_fixtures_.clear(); }

  [[nodiscard]] LocalizerState state() const { return localizer_.estimate().state; }
  /// How far [m] the best hypothesis is off.
  [[nodiscard]] double hypothesis_error() const {
    return distance(localizer_.hypotheses(1).front().pose, {x_, kMiddle, 0.0});
  }
  [[nodiscard]] double sigma() const { return position_sigma(localizer_.estimate().belief.covariance); }
  [[nodiscard]] double error() const { return distance(localizer_.estimate().belief.pose, {x_, kMiddle, 0.0}); }

 private:
  [[nodiscard]] static testing::TestBuilding corridor(std::optional<double> extra) {
    testing::TestBuilding corridor = testing::symmetric_corridor(10, kPitch);
    if (extra) {
      Fixture fixture = corridor.building.fixtures.back();
      ++fixture.id;
      fixture.world_from_fixture.x = *extra;
      corridor.building.fixtures.push_back(fixture);
    }
    return corridor;
  }
  void move(double linear, double time) {
    x_ += linear * time;
    odom_ += linear * time;
    utime_ += static_cast<std::int64_t>(1e6 * time);
  }
  [[nodiscard]] std::vector<FixtureSighting> look() const {
    std::vector<FixtureSighting> sightings;
    const auto see = [&](double at, const Fixture& fixture) {
      if (std::abs(at - x_) < reach_) {
        FixtureSighting sighting;
        sighting.robot_from_fixture = {at - x_, left_, turn_};
        sighting.covariance = Eigen::Vector3d(1e-5, 1e-5, 1e-5).asDiagonal();
        sighting.length = fixture.length;
        sighting.width = fixture.width;
        sighting.state = SightingState::kLit;
        sightings.push_back(sighting);
      }
    };
    for (const Fixture& fixture : corridor_.building.fixtures) {
      see(fixture.world_from_fixture.x, fixture);
    }
    for (const double x : false_fixtures_) {
      see(x, corridor_.building.fixtures.front());
    }
    return sightings;
  }

  testing::TestBuilding corridor_;
  ModernLocalizer localizer_;
  double x_ = 1.0;     // [m] true place along the corridor
  double odom_ = 0.0;  // [m]
  double reach_ = 0.5;
  double left_ = 0.0;  // [m]
  double turn_ = 0.0;  // [rad]
  bool hears_walls_ = false;
  std::int64_t utime_ = 1'000'000'000;
  std::int64_t session_ = 1;
  std::vector<double> false_fixtures_;  // [m]
};

bool any_about(const std::vector<std::string>& reasons, const std::string& words) {
  for (const std::string& reason : reasons) {
    if (reason.find(words) != std::string::npos) {
      return true;
    }
  }
  return false;
}

TEST(Suspicion, OfAPoseThatPredictsTheNextFixtureEndsThere) {
  CorridorDrive drive;
  drive.drive_to(8.0);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.hang_false_fixture(9.2);  // between those at 7.5 and 10.5
  EXPECT_TRUE(any_about(drive.drive_to(9.4), "where the building has none"));
  EXPECT_EQ(drive.state(), LocalizerState::kAmbiguous);
  drive.drive_to(10.6);
  EXPECT_EQ(drive.state(), LocalizerState::kTracking);
  EXPECT_LT(drive.error(), 0.05);
}

// Another pose explains the false fixture and the next one: the two at 25.5 and 27.2 are as far apart.
TEST(Suspicion, StaysWhereAnotherPoseExplainsTheFalseFixtureAndTheNext) {
  CorridorDrive drive(27.2);
  drive.drive_to(8.2);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.hang_false_fixture(8.8);
  EXPECT_TRUE(any_about(drive.drive_to(9.4), "where the building has none"));
  drive.drive_to(10.6);
  EXPECT_EQ(drive.state(), LocalizerState::kAmbiguous);
  EXPECT_LT(drive.error(), 0.05);
}

// Where every fixture looks like the next one no search finds it again.
TEST(Suspicion, OfABumpedRobotAndOfAFixtureThatMayHangElsewhereEndsAtTheNextFixture) {
  CorridorDrive drive;
  drive.drive_to(8.7);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.kidnap_to(9.1);
  drive.drive_to(10.6);
  EXPECT_NEAR(drive.error(), 0.2, 0.1) << "half way between both";
  EXPECT_GT(drive.sigma(), 0.1);
  drive.drive_to(13.6);
  EXPECT_EQ(drive.state(), LocalizerState::kTracking);
  EXPECT_LT(drive.error(), 0.05);
  EXPECT_LT(drive.sigma(), 0.1);
}

TEST(Suspicion, DoesNotComeBackAtAThingThatWasFoundOutToBeNoFixture) {
  CorridorDrive drive;
  drive.drive_to(8.0);
  drive.hang_false_fixture(9.2);
  drive.drive_to(11.0);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  EXPECT_TRUE(drive.drive_to(7.5).empty());
  EXPECT_TRUE(drive.drive_to(11.0).empty());
}

TEST(Suspicion, IsOfTheMapWhereAnotherFixtureSupportsThePoseMeanwhile) {
  for (const double off : {1.7, 0.8}) {
    CorridorDrive drive;
    drive.see_as_far_as(0.9);
    drive.drive_to(6.0);
    ASSERT_EQ(drive.state(), LocalizerState::kTracking);
    drive.hang_false_fixture(7.5 + off);  // with 1.7 m it is seen alone first
    EXPECT_EQ(drive.drive_to(10.0).empty(), off < 1.0) << off;
  }
}

// A bump turns what the robot sees; what hangs elsewhere is parallel to its place.
TEST(Suspicion, IsOfTheMapAsFarAsTheSonarsHearThatTheRobotDidNotMove) {
  struct Case {
    bool hears_walls;
    double turn;             // [rad]
    double least, greatest;  // [m] by which the pose gives way
  };
  for (const Case& c : {Case{true, 0.0, 0.0, 0.12}, Case{true, radians(12.0), 0.3, 0.5}, Case{false, 0.0, 0.12, 0.3}}) {
    CorridorDrive drive;
    if (c.hears_walls) {
      drive.hear_walls();
    }
    drive.drive_to(8.2);
    ASSERT_EQ(drive.state(), LocalizerState::kTracking);
    drive.hang_all_beside(0.4, c.turn);
    drive.drive_to(10.3);
    EXPECT_GE(drive.error(), c.least) << c.hears_walls << ", " << c.turn;
    EXPECT_LE(drive.error(), c.greatest) << c.hears_walls << ", " << c.turn;
  }
}

TEST(Suspicion, ComesWithinASecondOfImagesAfterTheRobotWasPutBetweenFixtures) {
  CorridorDrive drive;
  drive.drive_to(8.9);  // nothing ought to be in view here
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.kidnap_to(4.2);
  drive.drive_to(4.6);
  EXPECT_NE(drive.state(), LocalizerState::kTracking);
}

TEST(Suspicion, ComesWithFewImagesThatLackAFixtureAfterTheRobotStood) {
  CorridorDrive drive;
  drive.drive_to(8.9);
  drive.stand(1.5);  // nothing in view: who knows what happened to it
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.kidnap_to(5.0);
  drive.drive_to(6.25);  // five images after the fixture at 10.5 ought to be seen whole
  EXPECT_NE(drive.state(), LocalizerState::kTracking);
}

TEST(Suspicion, ComesWhereTheFixtureOverheadVanishesFromARobotThatHasJustStopped) {
  CorridorDrive drive;
  drive.drive_to(7.44);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.kidnap_to(6.0);  // nothing in view
  drive.roll_on(0.06);   // lifted while its wheels turn a little further
  EXPECT_FALSE(drive.stand(1.0));
}

TEST(Suspicion, ComesWhereAFixtureVanishesOfWhichTheImageShowedNoMoreThanHalf) {
  CorridorDrive drive;
  drive.see_as_far_as(1.2);
  drive.drive_to(6.36);
  drive.roll_on(0.02);  // the image's border is 1.08 m ahead, just before the middle of the fixture at 7.5
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  ASSERT_TRUE(drive.stand(1.0));
  drive.kidnap_to(3.0);  // nothing in view
  EXPECT_FALSE(drive.stand(1.0));
}

// It was seen with a third of it in the image, the most that may hide at the border of a robot that stands.
TEST(Suspicion, ComesWhereMoreOfAFixtureThatWasSeenMustBeInViewAndIsNot) {
  CorridorDrive drive;
  drive.see_as_far_as(1.35);
  drive.drive_to(6.22);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.see_as_far_as(0.3);
  drive.kidnap_to(3.0);  // nothing in view
  ASSERT_TRUE(drive.stand(1.5));
  drive.drive_to(3.5);  // no more than two thirds of the fixture at 7.5 would be in view
  EXPECT_NE(drive.state(), LocalizerState::kTracking);
}

TEST(Suspicion, DoesNotComeWhereLessOfAFixtureThatWasSeenWouldBeInView) {
  CorridorDrive drive;
  drive.see_as_far_as(1.2);
  drive.drive_to(6.5);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.see_as_far_as(0.3);
  EXPECT_TRUE(drive.drive_to(6.1).empty());
}

TEST(Suspicion, DoesNotComeFromFalseAlarmsHoweverLongTheRobotStandsBetweenFixtures) {
  CorridorDrive drive;
  drive.drive_to(8.9);
  for (int alarm = 0; alarm < 10; ++alarm) {
    drive.hang_false_fixture(8.8 + 0.02 * alarm);
    EXPECT_TRUE(drive.stand(0.4));
    drive.take_down_false_fixtures();
    EXPECT_TRUE(drive.stand(60.0));
  }
}

TEST(Suspicion, ComesWhileARobotIsPushedUnderAFixture) {
  CorridorDrive drive;
  drive.drive_to(7.3);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  EXPECT_TRUE(drive.push_to(7.8));
  EXPECT_NE(drive.state(), LocalizerState::kTracking);
}

TEST(Suspicion, OfAPushedRobotEndsWhereItRestsWithTheFixtureInViewAllTheTime) {
  CorridorDrive drive;
  drive.drive_to(7.3);
  drive.push_to(7.8);
  drive.stand(3.0);
  EXPECT_EQ(drive.state(), LocalizerState::kTracking);
  EXPECT_LT(drive.error(), 0.05);
}

TEST(Suspicion, OfARobotPushedOutOfSightOfItsFixtureEndsInASearch) {
  CorridorDrive drive;
  drive.drive_to(7.3);
  drive.push_to(9.0);
  EXPECT_EQ(drive.state(), LocalizerState::kLost);
  drive.drive_to(10.6);
  EXPECT_EQ(drive.state(), LocalizerState::kAmbiguous);
  drive.drive_to(13.6);  // here too all fixtures look alike
  EXPECT_EQ(drive.state(), LocalizerState::kAmbiguous);
}

TEST(Suspicion, OfARobotThatWasPlainlyMovedAwayIsNoneAndTheSearchAsTheFirst) {
  TrackingRules rules;
  rules.first_margin = 3.5;
  rules.enter_margin = 1000.0;  // after a doubt
  CorridorDrive drive(11.7, rules);
  drive.drive_to(7.3);
  drive.push_to(9.0);
  ASSERT_EQ(drive.state(), LocalizerState::kLost);
  drive.drive_to(20.0);  // past the one place that has no like
  EXPECT_EQ(drive.state(), LocalizerState::kTracking);
  EXPECT_LT(drive.error(), 0.05);
}

TEST(Suspicion, AfterTheSerialLineWasCutEndsAtTheFirstFixture) {
  for (const double driving : {0.0, 1.0, 2.2}) {
    CorridorDrive drive;
    drive.drive_to(8.4);
    ASSERT_EQ(drive.state(), LocalizerState::kTracking);
    drive.lose_odometry(driving, 4.0);
    EXPECT_TRUE(any_about(drive.drive_to(9.5), "odometry began anew")) << driving;
    EXPECT_NE(drive.state(), LocalizerState::kTracking) << driving;
    drive.drive_to(10.6);
    EXPECT_EQ(drive.state(), LocalizerState::kTracking) << driving;
    EXPECT_LT(drive.error(), 0.05) << driving;
  }
}

TEST(Suspicion, AfterALongCutInWhichTheRobotMayHaveBeenCarriedNeedsTwoFixtures) {
  CorridorDrive drive;
  drive.drive_to(8.4);
  ASSERT_EQ(drive.state(), LocalizerState::kTracking);
  drive.lose_odometry(1.0, 20.0);
  drive.drive_to(11.5);  // past the fixture at 10.5
  EXPECT_EQ(drive.state(), LocalizerState::kAmbiguous);
  drive.drive_to(13.6);  // under the next
  EXPECT_EQ(drive.state(), LocalizerState::kTracking);
  EXPECT_LT(drive.error(), 0.05);
}

TEST(Suspicion, TakesTheHypothesisAlongWhenTheRobotIsPushedInSight) {
  CorridorDrive drive;
  EXPECT_TRUE(drive.drive_to(4.0).size() < 5);
  EXPECT_FALSE(drive.push_to(4.9, 0.1)) << "slower than any slip, and always below the same fixture";
  EXPECT_LT(drive.error(), 0.1);
  EXPECT_LT(drive.hypothesis_error(), 0.1) << "the list must not hold another pose for the best than POSE says";
  EXPECT_TRUE(drive.drive_to(9.0).empty());
  EXPECT_LT(drive.hypothesis_error(), 0.05);
}

}  // namespace
}  // namespace luminav
