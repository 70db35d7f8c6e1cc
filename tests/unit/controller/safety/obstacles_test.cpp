#include "services/controller/safety/obstacles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

// an outline that does not fill its box
const Footprint kOctagon(
    {{0.2, -0.1}, {0.2, 0.1}, {0.1, 0.2}, {-0.2, 0.2}, {-0.3, 0.1}, {-0.3, -0.1}, {-0.2, -0.2}, {0.1, -0.2}});

struct Scene {
  std::vector<ObstaclePoint> measured;
  std::vector<Eigen::Vector2d> walls;
};

Scene random_scene(std::mt19937& random, std::size_t measured, std::size_t walls) {
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  Scene scene;
  for (std::size_t i = 0; i < measured; ++i) {
    scene.measured.push_back({{place(random), place(random)}, 0.0, 0.1, i % 3 == 0});
  }
  for (std::size_t i = 0; i < walls; ++i) {
    scene.walls.emplace_back(place(random), place(random));
  }
  return scene;
}

template <typename Counts>
double min_one_by_one(const Obstacles& obstacles, double max, const Counts& counts) {
  double min = max;
  for (const ObstaclePoint& obstacle : obstacles.points()) {
    min = counts(obstacle) ? std::min(min, obstacles.footprint().distance(obstacle.position)) : min;
  }
  return min;
}

TEST(Obstacles, AreTheMeasuredOnesThenTheWalls) {
  const std::vector<Eigen::Vector2d> walls{{2.0, 3.0}};
  Obstacles obstacles(kOctagon);
  obstacles.set(std::vector<ObstaclePoint>{{{1.0, 0.5}, 0.7, 0.2, false, true}}, walls);
  ASSERT_EQ(obstacles.points().size(), 2U);
  EXPECT_DOUBLE_EQ(obstacles.points()[0].approach, 0.7);
  EXPECT_FALSE(obstacles.points()[0].is_known);
  EXPECT_EQ(obstacles.points()[1].position, Eigen::Vector2d(2.0, 3.0));
  EXPECT_TRUE(obstacles.points()[1].is_known);
  EXPECT_DOUBLE_EQ(obstacles.points()[1].approach, 0.0);
}

TEST(Obstacles, TellHowFarNewsAreFromTheOutline) {
  const ObstaclePoint wall{{1.3, 0.0}, 0.0, 0.1, true, false};
  const ObstaclePoint what_stood{{1.4, 0.0}, 0.0, 0.1, false, true};
  const ObstaclePoint news{{1.5, 0.0}, 0.0, 0.1, false, false};
  const Obstacles obstacles(kOctagon, std::vector<ObstaclePoint>{wall, what_stood, news});
  EXPECT_NEAR(obstacles.min_unknown_distance(10.0), 1.2, 1e-9);
  EXPECT_NEAR(obstacles.min_news_distance(10.0), 1.3, 1e-9);
  EXPECT_DOUBLE_EQ(obstacles.min_news_distance(0.5), 0.5);
}

TEST(Obstacles, ForgetWhatStoodNearerBefore) {
  std::vector<ObstaclePoint> near(6);
  for (std::size_t i = 0; i < near.size(); ++i) {
    near[i].position = {0.3, 0.01 * static_cast<double>(i)};
  }
  Obstacles obstacles(kOctagon, near);
  obstacles.set(std::vector<ObstaclePoint>{{{1.2, 0.0}, 0.0, 0.1, false, false}}, {});
  EXPECT_DOUBLE_EQ(obstacles.min_distance(10.0), 1.0);
}

TEST(Obstacles, MeasureAsIfOneByOne) {
  std::mt19937 random(42);
  Obstacles obstacles(kOctagon);
  for (std::size_t size = 0; size < 200; ++size) {
    const Scene scene = random_scene(random, size / 3, size - size / 3);
    obstacles.set(scene.measured, scene.walls);
    EXPECT_EQ(obstacles.min_distance(10.0), min_one_by_one(obstacles, 10.0, [](const auto&) { return true; }));
    EXPECT_EQ(obstacles.min_unknown_distance(10.0),
              min_one_by_one(obstacles, 10.0, [](const auto& obstacle) { return !obstacle.is_known; }));
    EXPECT_EQ(obstacles.min_distance_ahead(0.2),
              min_one_by_one(obstacles, 0.2, [](const auto& obstacle) { return obstacle.position.x() > 0.0; }));
  }
}

TEST(Obstacles, AreVisitedInOrderWhereTheyAreNear) {
  std::mt19937 random(42);
  const Scene scene = random_scene(random, 50, 150);
  Obstacles obstacles(kOctagon);
  obstacles.set(scene.measured, scene.walls);
  std::vector<std::size_t> visited;
  obstacles.visit_within(0.4, [&](std::size_t i) { visited.push_back(i); });
  EXPECT_TRUE(std::is_sorted(visited.begin(), visited.end()));
  EXPECT_LT(visited.size(), obstacles.points().size() / 2);
  for (std::size_t i = 0; i < obstacles.points().size(); ++i) {
    if (kOctagon.distance(obstacles.points()[i].position) <= 0.4) {
      EXPECT_TRUE(std::binary_search(visited.begin(), visited.end(), i));
    }
  }
}

TEST(Obstacles, AreSeenFromAnotherPlace) {
  const Pose2 here_from_there{0.3, -0.2, 0.7};
  const Obstacles here(kOctagon, std::vector<ObstaclePoint>{{{1.0, 0.5}, 0.0, 0.0, false}});
  const Obstacles there = here.seen_from(here_from_there.inverse());
  const Eigen::Vector2d seen = there.points()[0].position;
  EXPECT_NEAR((here_from_there * seen - here.points()[0].position).norm(), 0.0, 1e-12);
  EXPECT_NEAR(there.min_distance(10.0), kOctagon.distance(seen), 1e-12);
}

}  // namespace
}  // namespace luminav
