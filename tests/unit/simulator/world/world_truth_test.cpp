#include "drivers/simulator/world/world_truth.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/free_space.hpp"
#include "drivers/simulator/world/lamp_state.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

/// A hall of 12 x 9 m, a corridor of 2 m along it, a door of 1 m between them, and a cupboard nobody gets into.
const std::vector<std::string> kFloor{
    "##########################", "#........................#", "#........................#",
    "#........................#", "#........................#", "############..############",
    "#........................#", "#........................#", "#........................#",
    "#........................#", "#........................#", "#........................#",
    "#.....................####", "#.....................#..#", "##########################"};

const Building& building() {
  static const Building made = [] {
    Building result = write_building("truth", kFloor);
    for (int i = 0; i < 30; ++i) {
      Fixture fixture;
      fixture.id = 100 + i;
      fixture.world_from_fixture = {1.0 + 0.3 * i, 2.0, 0.0};
      result.fixtures.push_back(fixture);
    }
    result.elements.resize(3);
    result.doors = {{1, {6.5, 4.75, 0.0}, 1.0}};
    return result;
  }();
  return made;
}

WorldTruth draw(const Scenario& scenario) {
  return draw_world(scenario, building(), test_robot());
}

/// Standard deviations over seeds of things that need no map.
class Deviations {
 public:
  explicit Deviations(Scenario scenario) {
    Building bare = building();
    bare.map_file.clear();
    scenario.start = Pose2{3.0, 3.0, 0.0};
    for (int seed = 0; seed < 1000; ++seed) {
      scenario.seed = static_cast<std::uint64_t>(seed);
      truths_.push_back(draw_world(scenario, bare, test_robot()));
    }
  }
  [[nodiscard]] double of(const std::function<double(const WorldTruth&)>& error) const {
    double squares = 0.0;
    for (const WorldTruth& truth : truths_) {
      squares += std::pow(error(truth), 2);
    }
    return std::sqrt(squares / static_cast<double>(truths_.size()));
  }

 private:
  std::vector<WorldTruth> truths_;
};

constexpr double kTolerance = 0.09;  // 4 sigma of a deviation from 1000 draws

double scale_error(const WorldTruth& t) {
  return 0.5 * (t.wheels.scale_left + t.wheels.scale_right) - 1.0;
}
double ratio_error(const WorldTruth& t) {
  return t.wheels.scale_right / t.wheels.scale_left - 1.0;
}
double base_error(const WorldTruth& t) {
  return t.robot.wheel_base / test_robot().wheel_base - 1.0;
}
double pitch_error(const WorldTruth& t) {
  return t.robot.camera.mounting.pitch;
}
double yaw_error(const WorldTruth& t) {
  return t.robot.camera.mounting.yaw;
}
double camera_height_error(const WorldTruth& t) {
  return t.robot.camera.mounting.z / test_robot().camera.mounting.z - 1.0;
}
double time_error(const WorldTruth& t) {
  return t.robot.camera.time_offset;
}
double k1_error(const WorldTruth& t) {
  return t.robot.camera.intrinsics.distortion[0];
}
double ceiling_error(const WorldTruth& t) {
  return t.building.ceiling_height / 2.8 - 1.0;
}
double fixture_error(const WorldTruth& t) {
  return t.building.fixtures[4].world_from_fixture.y - 2.0;
}
double fixture_heading_error(const WorldTruth& t) {
  return t.building.fixtures[4].world_from_fixture.theta;
}

TEST(WorldTruth, SpreadsAroundTheBeliefAsTheContractSays) {
  const Deviations deviation{Scenario{}};
  EXPECT_NEAR(deviation.of(scale_error) / 0.01, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(ratio_error) / 0.005, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(base_error) / 0.01, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(pitch_error) / radians(0.5), 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(yaw_error) / radians(0.5), 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(camera_height_error) / 0.01, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(time_error) / 0.020, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(k1_error) / 0.01, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(ceiling_error) / 0.005, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(fixture_error) / 0.010, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(fixture_heading_error) / radians(0.5), 1.0, kTolerance);
}

TEST(WorldTruth, KnowsConstantsTenTimesBetterWhenCalibrated) {
  Scenario scenario;
  scenario.world.calibrated = true;
  const Deviations deviation(scenario);
  EXPECT_NEAR(deviation.of(base_error) / 0.001, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(yaw_error) / radians(0.05), 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(fixture_error) / 0.003, 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(fixture_heading_error) / radians(0.2), 1.0, kTolerance);
  EXPECT_NEAR(deviation.of(ceiling_error) / 0.005, 1.0, kTolerance);  // the building's, not the robot's
  EXPECT_EQ(draw(scenario).wheels.noise_position, 0.01);              // noise is not calibrated away
}

TEST(WorldTruth, IsTheSameForTheSameSeed) {
  Scenario scenario;
  scenario.obstacles.resize(2);
  scenario.people.resize(1);
  const WorldTruth first = draw(scenario);
  const WorldTruth second = draw(scenario);
  EXPECT_EQ(first.hash, second.hash);
  EXPECT_EQ(first.start.x, second.start.x);
  EXPECT_EQ(first.obstacles[1].world_from_obstacle->x, second.obstacles[1].world_from_obstacle->x);
  EXPECT_EQ(first.people[0].waypoints, second.people[0].waypoints);
  scenario.seed = 2;
  EXPECT_NE(draw(scenario).hash, first.hash);
}

TEST(WorldTruth, KeepsTheRestWhenSomethingIsAdded) {
  Scenario scenario;
  const WorldTruth alone = draw(scenario);
  scenario.people.resize(2);
  scenario.obstacles.resize(1);
  scenario.lighting.off_ratio = 0.3;
  const WorldTruth crowded = draw(scenario);
  EXPECT_EQ(alone.robot.camera.mounting.roll, crowded.robot.camera.mounting.roll);
  EXPECT_EQ(alone.start.x, crowded.start.x);
  EXPECT_EQ(alone.building.fixtures[7].world_from_fixture.x, crowded.building.fixtures[7].world_from_fixture.x);
  EXPECT_EQ(alone.unlit_darker, crowded.unlit_darker);
}

TEST(WorldTruth, HasATableOfWhatWasDrawn) {
  const WorldTruth truth = draw({});
  EXPECT_THAT(truth.table, testing::HasSubstr("wheel_scale"));
  EXPECT_THAT(truth.table, testing::HasSubstr("grey_noise"));
  EXPECT_EQ(truth.hash.size(), 16U);
  Scenario kinder;
  kinder.world.grey_noise = 1.0;
  EXPECT_NE(draw(kinder).hash, truth.hash);
}

TEST(WorldTruth, SwitchesOffTheShareAskedFor) {
  Scenario scenario;
  scenario.lighting.off_ratio = 1.0 / 3.0;
  scenario.lighting.half = {100};
  scenario.lighting.flicker = {101};
  const WorldTruth truth = draw(scenario);
  const auto off = std::count(truth.lamp_states.begin() + 2, truth.lamp_states.end(), kLampOff);
  EXPECT_GE(off, 8);
  EXPECT_LE(off, 10);
  EXPECT_EQ(truth.lamp_states[0], kLampHalf);
  EXPECT_EQ(truth.lamp_states[1], kLampFlicker);
}

TEST(WorldTruth, StartsInTheLargestRegionAwayFromWalls) {
  Scenario scenario;
  const PriorMap map = map_from_text(kFloor);
  const DistanceField distances = distance_to_not_free(map);
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    scenario.seed = seed;
    const Pose2 start = draw(scenario).start;
    EXPECT_GE(distances.at(start.position()), 0.45);
    EXPECT_FALSE(start.x > 11.0 && start.y < 1.0);  // the cupboard
  }
}

TEST(WorldTruth, CarriesToPlacesWhereARobotCanStand) {
  Scenario scenario;
  scenario.obstacles = {{Pose2{6.0, 3.0, 0.0}, 0.5, 0.5, ObstacleKind::kBox}};
  scenario.events.resize(2);
  for (ScenarioEvent& event : scenario.events) {
    event.kind = EventKind::kCarry;
    event.has_place = false;
  }
  const DistanceField distances = distance_to_not_free(map_from_text(kFloor));
  const Pose2 start = draw(scenario).start;
  std::set<double> headings;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    scenario.seed = seed;
    for (const ScenarioEvent& event : draw(scenario).events) {
      EXPECT_GE(distances.at(event.pose.position()), 0.45);
      EXPECT_GE((event.pose.position() - Eigen::Vector2d(6.0, 3.0)).norm(), 0.6 + 0.25);
      headings.insert(event.pose.theta);
    }
  }
  EXPECT_EQ(headings.size(), 120U);
  scenario.seed = Scenario{}.seed;
  EXPECT_EQ(draw(scenario).start.x, start.x);
}

TEST(WorldTruth, RefusesTheImpossible) {
  Scenario scenario;
  scenario.start = Pose2{0.3, 3.0, 0.0};
  EXPECT_THROW(draw(scenario), ConfigurationError);  // in a wall
  scenario.start = Pose2{3.0, 3.0, 0.0};
  EXPECT_NO_THROW(draw(scenario));
  scenario.lighting.off = {5};
  EXPECT_THROW(draw(scenario), ConfigurationError);  // no such fixture
  scenario.lighting.off.clear();
  scenario.obstacles = {{Pose2{3.2, 3.0, 0.0}, 0.5, 0.5, ObstacleKind::kBox}};
  EXPECT_THROW(draw(scenario), ConfigurationError);  // the start is in a box
  scenario.obstacles = {{std::nullopt, 8.0, 4.0, ObstacleKind::kBox}};
  EXPECT_THROW(draw(scenario), ConfigurationError);  // no room
  scenario.obstacles.clear();
  scenario.events.resize(1);
  scenario.events[0].kind = EventKind::kCarry;
  scenario.events[0].pose = {0.0, 0.0, 0.0};
  EXPECT_THROW(draw(scenario), ConfigurationError);  // carried into a wall
  Building bare = building();
  bare.map_file.clear();
  EXPECT_THROW(draw_world({}, bare, test_robot()), ConfigurationError);  // nothing to draw a start from
}

TEST(WorldTruth, TakesAGoalInAWall) {
  Scenario scenario;
  scenario.goals.resize(1);
  scenario.goals[0].expect_refused = true;
  scenario.goals[0].pose = {0.1, 0.1, 0.0};
  EXPECT_NO_THROW(draw(scenario));
}

class RandomObstacles : public testing::TestWithParam<int> {};

TEST_P(RandomObstacles, LeaveTheRobotItsWays) {
  Scenario scenario;
  scenario.seed = static_cast<std::uint64_t>(GetParam());
  scenario.obstacles = {{std::nullopt, 0.6, 0.4, ObstacleKind::kBox}, {std::nullopt, 0.5, 0.5, ObstacleKind::kBox}};
  scenario.goals.resize(2);
  scenario.goals[0].pose = {2.0, 6.0, 0.0};
  scenario.goals[1].pose = {10.0, 3.0, 0.0};
  const WorldTruth truth = draw(scenario);
  PriorMap map = map_from_text(kFloor);
  const DistanceField walls = distance_to_not_free(map);
  for (const Obstacle& obstacle : truth.obstacles) {
    const Polygon outline = rectangle(*obstacle.world_from_obstacle, obstacle.length, obstacle.width);
    EXPECT_GE(distance(outline, truth.start.position()), 1.0);
    for (const ScenarioGoal& goal : scenario.goals) {
      EXPECT_GE(distance(outline, goal.pose.position()), 1.0);
    }
    double nearest = 10.0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      nearest = std::min(nearest, walls.at(outline[i]));
      for (double t = 0.0; t < 1.0; t += 0.05) {
        nearest = std::min(nearest, walls.at(Vector2d(outline[i] + t * (outline[(i + 1) % 4] - outline[i]))));
      }
    }
    EXPECT_TRUE(nearest <= 0.10 || nearest >= 0.85) << "neither clear of the walls nor against one: " << nearest;
    for (int row = 0; row < map.geometry.rows; ++row) {
      for (int column = 0; column < map.geometry.columns; ++column) {
        const double gap = distance(outline, map.geometry.centre_of({column, row}));
        Prior& cell = map.cells[map.geometry.index({column, row})];
        EXPECT_TRUE(gap > 0.0 || cell == Prior::kFree) << "stands in a wall";
        cell = gap < 0.03 ? Prior::kOccupied : cell;
      }
    }
  }
  // a robot of 0.40 m radius still gets from the start to all goals
  const DistanceField left = distance_to_not_free(map);
  std::vector<bool> passes(map.geometry.size());
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      passes[map.geometry.index({column, row})] = left.at(Cell{column, row}) >= 0.40;
    }
  }
  const std::vector<int> labels = label_regions(map.geometry, passes);
  const auto label_at = [&](const Pose2& pose) {
    return labels[map.geometry.index(map.geometry.cell_at(pose.position()))];
  };
  EXPECT_GE(label_at(truth.start), 0);
  for (const ScenarioGoal& goal : scenario.goals) {
    EXPECT_EQ(label_at(goal.pose), label_at(truth.start));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomObstacles, testing::Range(0, 40));

TEST(WorldTruth, GivesPeopleAFreeStraightWay) {
  Scenario scenario;
  scenario.people.resize(2);
  scenario.obstacles.resize(1);
  const DistanceField walls = distance_to_not_free(map_from_text(kFloor));
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    scenario.seed = seed;
    const WorldTruth truth = draw(scenario);
    for (const WalkingPerson& person : truth.people) {
      ASSERT_EQ(person.waypoints.size(), 2U);
      const Vector2d leg = person.waypoints[1] - person.waypoints[0];
      EXPECT_GE(leg.norm(), 3.0);
      const Obstacle& box = truth.obstacles[0];
      for (double t = 0.0; t <= 1.0; t += 0.02) {
        const Vector2d point = person.waypoints[0] + t * leg;
        EXPECT_GE(walls.at(point), kPersonRadius);
        EXPECT_GE(distance(rectangle(*box.world_from_obstacle, box.length, box.width), point), kPersonRadius);
      }
    }
  }
}

TEST(WorldTruth, PlacesNothingOverAHole) {
  Scenario scenario;
  scenario.holes = {{{3.0, 2.5, 0.0}, 3.0, 3.0}};
  scenario.obstacles.resize(1);
  scenario.people.resize(1);
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    scenario.seed = seed;
    const WorldTruth truth = draw(scenario);
    ASSERT_EQ(truth.holes.size(), 1U);
    EXPECT_GT(distance(truth.holes[0], truth.start.position()), 0.4);
    const Obstacle& box = truth.obstacles[0];
    for (const Vector2d& corner : rectangle(*box.world_from_obstacle, box.length, box.width)) {
      EXPECT_GT(distance(truth.holes[0], corner), 0.0);
    }
    EXPECT_GT(distance(truth.holes[0], Polygon{truth.people[0].waypoints[0], truth.people[0].waypoints[1]}), 0.0);
  }
  scenario.start = Pose2{3.0, 2.5, 0.0};
  EXPECT_THROW(draw(scenario), ConfigurationError);
}

TEST(DrawFreePoint, IsTheSameForTheSameState) {
  const PriorMap map = map_from_text(kFloor);
  SplitMix first(17);
  SplitMix second(17);
  EXPECT_EQ(draw_free_point(map, 0.5, first), draw_free_point(map, 0.5, second));
  EXPECT_EQ(first.next(), second.next());
  EXPECT_NE(draw_free_point(map, 0.5, first), draw_free_point(map, 0.5, first));
  EXPECT_THROW(draw_free_point(map, 5.0, first), ConfigurationError);
}

TEST(DistanceField, IsExactFromCentreToCentreLessHalfACell) {
  const PriorMap map = map_from_text({"#####", "#####", "##.##", "#####", "#...#"}, 0.5);
  const DistanceField field = distance_to_walls(map);
  for (const Vector2d& point : {Vector2d(1.225, 1.275), Vector2d(0.775, 0.225), Vector2d(1.025, 1.475)}) {
    double expected = 100.0;
    for (int row = 0; row < map.geometry.rows; ++row) {
      for (int column = 0; column < map.geometry.columns; ++column) {
        if (map.cells[map.geometry.index({column, row})] == Prior::kOccupied) {
          expected = std::min(expected, (map.geometry.centre_of({column, row}) - point).norm() - 0.025);
        }
      }
    }
    EXPECT_NEAR(field.at(point), expected, 1e-6);
  }
  EXPECT_EQ(field.at(Vector2d(0.1, 1.0)), 0.0);
  EXPECT_EQ(field.at(Vector2d(-1.0, 1.0)), DistanceField::kFar);
  EXPECT_EQ(distance_to_not_free(map).at(Vector2d(-1.0, 1.0)), 0.0);
}

}  // namespace
}  // namespace luminav
