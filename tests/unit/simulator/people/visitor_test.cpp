#include "drivers/simulator/people/visitor.hpp"

#include <gtest/gtest.h>

#include "drivers/simulator/arcos/battery.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

constexpr double kSpeed = 0.5;  // [m/s]

/// A robot at the western end of a long hall, and somebody behind it.
class Hall {
 public:
  explicit Hall(const VisitorHabit& habit) : world(1, truth()) { EXPECT_TRUE(world.add_visitor(habit)); }
  static WorldTruth truth() {
    WorldTruth truth = exact_truth(map_from_text(hall(60, 10)), {3.0, 3.0, 0.0});
    truth.robot.sonar.robot_from_sonar = {{-0.255, 0.027, radians(170.0)}};
    return truth;
  }
  void drive(double seconds, double linear = kSpeed, double angular = 0.0) {
    for (double t = 0.0; t < seconds; t += World::kTick) {
      world.step({linear, angular, true});
    }
  }
  [[nodiscard]] double fallen_back() const {
    return (world.people()[0].centre - world.state().world_from_robot.position()).norm();
  }
  World world;
};

TEST(Visitor, KeepsAMetreBehindTheRobot) {
  Hall h({});
  EXPECT_NEAR(h.world.people()[0].centre.x(), 1.7, 0.01);
  h.drive(4.0);
  for (int i = 0; i < 20; ++i) {
    h.drive(1.0);
    EXPECT_NEAR(h.fallen_back(), 1.05, 0.15);
  }
  h.drive(5.0, 0.0);
  EXPECT_NEAR(h.fallen_back(), 1.05, 0.15) << "he does not walk into a robot that stands";
}

TEST(Visitor, IsHeardByTheSonarBehindTheRobot) {
  Hall h({});
  h.drive(4.0);
  int heard = 0;
  for (int i = 0; i < 100; ++i) {
    h.drive(0.2);
    const double range = h.world.measure_sonar(0);
    heard += range > 0.3 && range < 0.8 ? 1 : 0;
  }
  EXPECT_GT(heard, 90);
}

TEST(Visitor, FallsBackWhenHeIsSlower) {
  Hall h({.speed = 0.3});
  h.drive(20.0);
  EXPECT_NEAR(h.fallen_back(), 1.3 + 20.0 * (kSpeed - 0.3), 0.9);
  h.drive(20.0, 0.0);
  EXPECT_NEAR(h.fallen_back(), 1.05, 0.15) << "who is waited for comes";
}

TEST(Visitor, StopsAndComesAfter) {
  Hall h({.stops_after = 3.0, .stops_for = 10.0});
  h.drive(16.0);
  EXPECT_GT(h.fallen_back(), 4.0);
  h.drive(20.0, 0.0);
  EXPECT_NEAR(h.fallen_back(), 1.05, 0.15);
}

TEST(Visitor, TurnsAwayForGood) {
  Hall h({.stops_after = 3.0, .leaves = true});
  h.drive(6.0);
  EXPECT_EQ(h.world.people().size(), 1U);
  h.drive(20.0);
  EXPECT_TRUE(h.world.people().empty());
}

TEST(Visitor, StepsAsideForARobotThatComesBack) {
  Hall h({.speed = 0.4, .stops_after = 4.0, .stops_for = 1000.0});
  h.drive(20.0);
  const Eigen::Vector2d stood = h.world.people()[0].centre;
  h.drive(2.0, 0.0, 0.5 * kPi);
  h.drive(18.0);
  EXPECT_EQ(h.world.contacts().contacts(), 0);
  EXPECT_LT(h.world.state().world_from_robot.x, stood.x() - 0.5) << "it got past him";
}

TEST(Visitor, WalksRoundWhatIsInHisWay) {
  for (const double open_side : {1.0, -1.0}) {  // of a wall across his way
    Visitor visitor({}, {0.0, 0.0});
    const auto is_free = [&](const Eigen::Vector2d& point) {
      return point.x() < 1.8 || point.x() > 2.8 || point.y() * open_side > 1.0;
    };
    for (int i = 0; i < 2000; ++i) {
      visitor.step(0.01, {i == 0 ? 4.0 : 5.2, 0.0, 0.0}, is_free);
    }
    EXPECT_GT(visitor.position().x(), 3.5);
  }
}

TEST(Visitor, IsNotWhereThereIsNoRoom) {
  World world(1, exact_truth(map_from_text({"###", "#.#", "###"}, 1.0), {1.5, 1.5, 0.0}));
  EXPECT_FALSE(world.add_visitor({}));
  EXPECT_FALSE(world.add_bystander({1.5, 1.5}));
  EXPECT_TRUE(world.people().empty());
}

TEST(Visitor, StandsInTheWayUntilHeGoes) {
  World world(1, exact_truth(map_from_text(hall(60, 10)), {3.0, 3.0, 0.0}));
  ASSERT_TRUE(world.add_bystander({6.0, 3.0}));
  ASSERT_TRUE(world.add_visitor({}));
  for (int i = 0; i < 300; ++i) {
    world.step({0.0, 0.0, true});
  }
  world.remove_visitors();
  ASSERT_EQ(world.people().size(), 1U);
  EXPECT_NEAR(world.people()[0].centre.x(), 6.0, 1e-9);
  world.remove_bystanders();
  EXPECT_TRUE(world.people().empty());
}

TEST(Dock, ChargesWhereTheRobotStandsInIt) {
  WorldTruth truth = exact_truth(map_from_text(hall(60, 10)), {3.0, 3.0, 0.0});
  truth.dock = Dock{"dock", {5.0, 3.0, 0.0}, 0.08, radians(6.0), 1.0};
  World world(1, truth);
  const auto drive = [&](double linear, double angular, double seconds) {
    for (double t = 0.0; t < seconds; t += World::kTick) {
      world.step({linear, angular, true});
    }
  };
  drive(0.5, 0.0, 4.0);
  EXPECT_FALSE(world.is_on_charger()) << "it drives by";
  drive(0.0, 0.0, 0.5);
  EXPECT_TRUE(world.is_on_charger());
  drive(0.0, 0.2, 1.0);
  EXPECT_FALSE(world.is_on_charger()) << "it turned away by 11 degrees";
}

TEST(Battery, ChargesInBulkAndThenLess) {
  Battery battery(11.7);
  EXPECT_NEAR(battery.voltage(), 11.7, 1e-9);
  EXPECT_EQ(battery.charge_state(), 0);
  battery.step(1.0, true, 0.0, 0.0, true);
  EXPECT_GT(battery.voltage(), 12.8) << "a charger is heard at once";
  EXPECT_EQ(battery.charge_state(), 1);
  int seconds = 0;
  for (; battery.charge_state() == 1; ++seconds) {
    battery.step(1.0, true, 0.0, 0.0, true);
  }
  EXPECT_NEAR(seconds / 3600.0, 2.0, 0.3);
  for (; battery.charge_state() == 2; ++seconds) {
    battery.step(1.0, true, 0.0, 0.0, true);
  }
  EXPECT_EQ(battery.charge_state(), 3);
  battery.step(1.0, true, 0.0, 0.0, false);
  EXPECT_EQ(battery.charge_state(), 0);
  EXPECT_NEAR(battery.voltage(), 12.85, 0.05);
}

}  // namespace
}  // namespace luminav
