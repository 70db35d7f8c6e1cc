#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/free_space.hpp"
#include "drivers/simulator/world/scenario.hpp"

namespace luminav {

/// Finds places for obstacles that the map does not know, so that a robot still gets everywhere it got before: each
/// stands clear of the walls by a passage's width or against one, away from the points named, and cuts no passage.
class ObstaclePlacement {
 public:
  explicit ObstaclePlacement(const FreeSpace& space);

  /// Nothing is placed within 1 m of this point: the start, a goal.
  void keep_away_from(const Eigen::Vector2d& point) { points_.push_back(point); }
  /// Nothing is placed where a person walks.
  void keep_clear(const Eigen::Vector2d& from, const Eigen::Vector2d& to) { lines_.emplace_back(from, to); }
  /// Stands there already.
  void add(const Polygon& outline);

  /// Draws a pose and adds the obstacle. Throws ConfigurationError when there is no room.
  Pose2 draw(const Obstacle& obstacle, RandomStream& random);

 private:
  [[nodiscard]] bool is_clear_of_others(const Polygon& outline) const;
  [[nodiscard]] bool cuts_a_passage(const Polygon& outline) const;

  const FreeSpace& space_;
  std::vector<float> distances_;  // [m] per cell to walls and to the obstacles that were added
  std::vector<Polygon> others_;
  std::vector<Eigen::Vector2d> points_;
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> lines_;
};

}  // namespace luminav
