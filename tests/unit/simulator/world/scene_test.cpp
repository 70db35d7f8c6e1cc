#include "drivers/simulator/world/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

const std::vector<char> kNoneHeard(8, 0);
const std::vector<char> kAllHeard(8, 1);

/// A hall of 10 x 6 m inside walls of half a metre: free from 0.5 to 10.5 and from 0.5 to 6.5.
WorldTruth empty_hall() {
  return exact_truth(map_from_text(hall(20, 12)), {5.0, 3.0, 0.0});
}

Obstacle obstacle_at(const Pose2& pose, double length, double width, ObstacleKind kind) {
  return {pose, length, width, kind};
}

TEST(Scene, MeasuresTheClearanceToAWallExactlyWhenItIsNear) {
  const WorldTruth truth = empty_hall();
  const Scene scene(truth);
  for (const double gap : {0.001, 0.013, 0.05, 0.10, 0.149}) {
    const Polygon outline = transform({10.5 - 0.21 - gap, 3.0, 0.0}, truth.robot.footprint);
    EXPECT_NEAR(scene.separation(outline).to(SolidKind::kWall), gap, 1e-6);
  }
  const Polygon far = transform({5.0, 3.0, 0.0}, truth.robot.footprint);
  EXPECT_NEAR(scene.separation(far).to(SolidKind::kWall), 2.5 - 0.2125, 0.075);
  EXPECT_EQ(scene.separation(far).to(SolidKind::kPerson), Separation::kNoneNear);
}

TEST(Scene, HasNoSeparationInAWall) {
  const WorldTruth truth = empty_hall();
  const Scene scene(truth);
  EXPECT_EQ(scene.separation(transform({10.4, 3.0, 0.0}, truth.robot.footprint)).nearest(), 0.0);
  EXPECT_EQ(scene.separation(transform({5.0, 6.4, 0.7}, truth.robot.footprint)).nearest(), 0.0);
}

TEST(Scene, FindsASingleCellThatThePerimeterSamplesStraddle) {
  WorldTruth truth = exact_truth(map_from_text(hall(20, 12)), {5.0, 3.0, 0.0});
  const Cell post = truth.walls.geometry.cell_at({6.0, 3.0});
  truth.walls.cells[truth.walls.geometry.index(post)] = Prior::kOccupied;
  const double left_side = truth.walls.geometry.centre_of(post).x() - 0.025;
  const Scene scene(truth);
  for (double y = 2.85; y < 3.2; y += 0.007) {
    EXPECT_NEAR(scene.separation(transform({left_side - 0.21 - 0.02, y, 0.0}, truth.robot.footprint)).nearest(), 0.02,
                1e-6);
  }
}

TEST(Scene, TellsBoxesFromHardThingsAndPeople) {
  WorldTruth truth = empty_hall();
  truth.obstacles = {obstacle_at({7.0, 3.0, 0.0}, 1.0, 1.0, ObstacleKind::kBox),
                     obstacle_at({5.0, 5.0, 0.0}, 1.0, 1.0, ObstacleKind::kTable)};
  truth.people = {{{{3.0, 3.0}, {3.0, 5.0}}, 0.8}};
  const Scene scene(truth);
  const Separation separation = scene.separation(transform({5.0, 3.0, 0.0}, truth.robot.footprint));
  EXPECT_NEAR(separation.to(SolidKind::kBox), 1.5 - 0.21, 1e-9);
  EXPECT_NEAR(separation.to(SolidKind::kHard), 1.5 - 0.2125, 1e-9);
  EXPECT_NEAR(separation.to(SolidKind::kPerson), 2.0 - 0.301 - kPersonRadius, 1e-9);
  EXPECT_NEAR(separation.nearest(), 1.5 - 0.2125, 1e-9);
}

TEST(Scene, LetsTheRobotBetweenTheLegsOfAChairButNotThroughATable) {
  WorldTruth truth = empty_hall();
  truth.obstacles = {obstacle_at({5.0, 3.0, 0.0}, 1.2, 1.2, ObstacleKind::kLegs)};
  EXPECT_GT(Scene(truth).separation(transform({5.0, 3.0, 0.0}, truth.robot.footprint)).nearest(), 0.2);
  truth.obstacles.front().kind = ObstacleKind::kTable;
  EXPECT_EQ(Scene(truth).separation(transform({5.0, 3.0, 0.0}, truth.robot.footprint)).nearest(), 0.0);
}

TEST(Scene, StopsARayAtAWallAndSaysWhereItFaces) {
  const WorldTruth truth = empty_hall();
  const Scene scene(truth);
  for (const double degrees_off : {0.0, 10.0, -20.0}) {
    const Vector2d direction(std::cos(radians(degrees_off)), std::sin(radians(degrees_off)));
    const auto hit = scene.cast_ray({5.0, 3.0}, direction, 8.0, kNoneHeard);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->distance, 5.5 / std::cos(radians(degrees_off)), 1e-9);
    EXPECT_NEAR(hit->normal.x(), -1.0, 1e-3);
    EXPECT_NEAR(hit->normal.y(), 0.0, 0.05);
  }
  EXPECT_FALSE(scene.cast_ray({5.0, 3.0}, {1.0, 0.0}, 5.0, kNoneHeard).has_value());  // beyond its range
}

TEST(Scene, SeesASlantedWallAsSmooth) {
  // cells below the line y = 2 + slope * x are wall
  for (const double slope : {0.2, 0.5, 1.0}) {
    PriorMap map = map_from_text(hall(20, 20));
    for (int row = 0; row < map.geometry.rows; ++row) {
      for (int column = 0; column < map.geometry.columns; ++column) {
        const Vector2d centre = map.geometry.centre_of({column, row});
        if (centre.y() < 2.0 + slope * (centre.x() - 3.0)) {
          map.cells[map.geometry.index({column, row})] = Prior::kOccupied;
        }
      }
    }
    const WorldTruth truth = exact_truth(map, {4.0, 9.0, 0.0});
    const Scene scene(truth);
    const Vector2d wanted = Vector2d(-slope, 1.0).normalized();
    double worst = 0.0;
    for (double x = 3.0; x < 6.0; x += 0.0131) {
      const auto hit = scene.cast_ray({x, 9.0}, {0.0, -1.0}, 12.0, kNoneHeard);
      ASSERT_TRUE(hit.has_value());
      worst = std::max(worst, std::acos(std::min(1.0, hit->normal.dot(wanted))));
    }
    EXPECT_LT(degrees(worst), 12.0) << "slope " << slope;
  }
}

TEST(Scene, LooksIntoACornerAlongItsBisector) {
  const WorldTruth truth = empty_hall();
  const auto hit = Scene(truth).cast_ray({9.0, 5.0}, Vector2d(1.0, 1.0).normalized(), 5.0, kNoneHeard);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->normal.x(), hit->normal.y(), 0.05);
}

TEST(Scene, HidesLegsFromAPulseThatDoesNotHearThem) {
  WorldTruth truth = empty_hall();
  truth.obstacles = {obstacle_at({6.0, 3.0, 0.25 * kPi}, 0.5, 0.5, ObstacleKind::kLegs)};
  const Scene scene(truth);
  const auto heard = scene.cast_ray({5.0, 3.0}, {1.0, 0.0}, 5.0, kAllHeard);
  ASSERT_TRUE(heard.has_value());
  EXPECT_EQ(heard->surface, Surface::kThin);
  EXPECT_FALSE(scene.cast_ray({5.0, 3.0}, {1.0, 0.0}, 5.0, kNoneHeard).has_value());
}

TEST(Scene, StopsRaysAtClosedDoorsOnly) {
  WorldTruth truth = empty_hall();
  truth.building.doors = {{1, {6.0, 3.0, 0.5 * kPi}, 1.0}};
  Scene scene(truth);
  EXPECT_FALSE(scene.cast_ray({5.0, 3.0}, {1.0, 0.0}, 3.0, kNoneHeard).has_value());
  scene.set_door_closed(0, true);
  const auto hit = scene.cast_ray({5.0, 3.0}, {1.0, 0.0}, 3.0, kNoneHeard);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance, 1.0 - 0.02, 1e-9);
}

TEST(Scene, WorksWithoutAMap) {
  const WorldTruth truth = exact_truth({}, {});
  const Scene scene(truth);
  EXPECT_EQ(scene.separation(truth.robot.footprint).nearest(), Separation::kNoneNear);
  EXPECT_FALSE(scene.cast_ray({0.0, 0.0}, {1.0, 0.0}, 5.0, kNoneHeard).has_value());
}

}  // namespace
}  // namespace luminav
