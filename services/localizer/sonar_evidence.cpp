#include "services/localizer/sonar_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kFromWall = 0.6;  // share of echoes that come from the building's walls

}  // namespace

double log_likelihood_of_echoes(const PoseBelief& belief, std::span<const PlacedEcho> echoes, const WallField& walls,
                                double half_angle) {
  const Pose2& pose = belief.pose;
  const double sigma = 0.12 + position_sigma(belief.covariance);
  double sum = 0.0;
  for (const PlacedEcho& echo : echoes) {
    const Eigen::Vector2d axis = echo.end - echo.disc;
    double nearest = 1e9;
    double farthest_wall = 0.0;
    const Eigen::Vector2d disc = pose * echo.disc;
    for (const double across : {-0.7, 0.0, 0.7}) {
      const double turn = across * half_angle;
      const Eigen::Vector2d offset(std::cos(turn) * axis.x() - std::sin(turn) * axis.y(),
                                   std::sin(turn) * axis.x() + std::cos(turn) * axis.y());
      const Eigen::Vector2d end = pose * Eigen::Vector2d(echo.disc + offset);
      nearest = std::min(nearest, walls.distance_to_wall(end));
      farthest_wall = std::max(farthest_wall, walls.range_to_wall(disc, (end - disc).normalized(), echo.range));
    }
    const double hit = nearest / sigma;
    sum += std::log(1.0 + kFromWall / (1.0 - kFromWall) * std::exp(-0.5 * hit * hit));
    // an echo from behind a wall: only a map that is wrong there explains it
    if (farthest_wall < echo.range - 0.3 - 2.0 * sigma) {
      sum -= 0.7;
    }
  }
  return sum;
}

}  // namespace luminav
