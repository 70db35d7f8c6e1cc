#include "services/localizer/hypotheses/trajectory_check.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace luminav {
namespace {

/// 4 m x 4 m of cells of 0.1 m, free but for a wall of two cells at x = 2 m with a doorway from y = 1 m to 2 m.
WallField walls_with_doorway() {
  PriorMap map;
  map.geometry = {0.1, {0.0, 0.0}, 40, 40};
  map.cells.assign(map.geometry.size(), Prior::kFree);
  for (int row = 0; row < 40; ++row) {
    for (const int column : {19, 20}) {
      if (row < 10 || row >= 20) {
        map.cells[map.geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  return WallField(map);
}

PoseBelief belief_at(double x, double y, double sigma) {
  PoseBelief belief;
  belief.pose = {x, y, 0.0};
  belief.covariance = Eigen::Vector3d(sigma * sigma, sigma * sigma, 0.01).asDiagonal();
  return belief;
}

/// The robot drove a metre straight ahead.
std::vector<Eigen::Vector2d> metre_ahead() {
  TrajectoryCheck trail;
  bool is_complete = false;
  for (int i = 0; i < 100; ++i) {
    is_complete = trail.advance({0.01, 0.0, 0.0}) || is_complete;
  }
  EXPECT_TRUE(is_complete);
  return trail.points();
}

TEST(TrajectoryCheck, HoldsNothingAgainstAPoseThatCameThroughTheDoorway) {
  EXPECT_EQ(log_likelihood_of_trail(belief_at(2.5, 1.5, 0.05), metre_ahead(), walls_with_doorway()), 0.0);
  EXPECT_EQ(log_likelihood_of_trail(belief_at(2.5, 1.1, 0.05), metre_ahead(), walls_with_doorway()), 0.0);
}

TEST(TrajectoryCheck, RefutesAPoseThatCameThroughTheWall) {
  EXPECT_LT(log_likelihood_of_trail(belief_at(2.6, 3.0, 0.05), metre_ahead(), walls_with_doorway()), -6.0);
  EXPECT_EQ(log_likelihood_of_trail(belief_at(1.5, 3.0, 0.05), metre_ahead(), walls_with_doorway()), 0.0);
}

TEST(TrajectoryCheck, LeavesAPoseThatIsHardlyKnownMostOfItsWeight) {
  const double sure = log_likelihood_of_trail(belief_at(2.5, 2.3, 0.05), metre_ahead(), walls_with_doorway());
  const double unsure = log_likelihood_of_trail(belief_at(2.5, 2.3, 0.6), metre_ahead(), walls_with_doorway());
  EXPECT_LT(sure, -2.0);
  EXPECT_GT(unsure, -1.0);
}

TEST(TrajectoryCheck, ForgetsWhatLiesFarBack) {
  TrajectoryCheck trail;
  for (int i = 0; i < 1000; ++i) {
    if (trail.advance({0.01, 0.0, 0.0})) {
      EXPECT_LT(trail.points().front().norm(), 1.5);
    }
  }
  trail.clear();
  EXPECT_TRUE(trail.points().empty());
}

TEST(TrajectoryCheck, SaysNothingWithoutAMap) {
  EXPECT_EQ(log_likelihood_of_trail(belief_at(2.5, 3.0, 0.05), metre_ahead(), WallField{}), 0.0);
}

}  // namespace
}  // namespace luminav
