#include "services/localizer/sonar_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr double kFromWall = 0.6;    // share of echoes that come from the building's walls
constexpr double kBehindWall = 0.7;  // that an echo from behind a wall speaks against the pose
constexpr double kInWall = 0.05;     // [m] from a wall's face to the middle of its cell, to which distances are
constexpr std::array kAcross = {-0.9, -0.45, 0.0, 0.45, 0.9};  // where a beam is looked at, in half angles

}  // namespace

double log_likelihood_of_echoes(const PoseBelief& belief, std::span<const PlacedEcho> echoes, const WallField& walls,
                                double half_angle) {
  const PointTransform world_from_robot(belief.pose);
  const double sigma = 0.12 + position_sigma(belief.covariance);
  std::array<Eigen::Vector2d, kAcross.size()> fan;  // directions beside a beam's axis, as cosine and sine
  for (std::size_t i = 0; i < fan.size(); ++i) {
    fan[i] = {std::cos(kAcross[i] * half_angle), std::sin(kAcross[i] * half_angle)};
  }
  double sum = 0.0;
  for (const PlacedEcho& echo : echoes) {
    const Eigen::Vector2d axis = echo.end - echo.disc;
    const Eigen::Vector2d disc = world_from_robot * echo.disc;
    // an echo from behind a wall, on all of the beam: only a map that is wrong there explains it
    const double behind = echo.range - 0.3 - 2.0 * sigma;
    bool is_behind = behind > 0.0;
    double nearest = 1e9;
    for (const Eigen::Vector2d& turn : fan) {
      const Eigen::Vector2d offset(turn.x() * axis.x() - turn.y() * axis.y(),
                                   turn.y() * axis.x() + turn.x() * axis.y());
      const Eigen::Vector2d end = world_from_robot * Eigen::Vector2d(echo.disc + offset);
      // What is behind the first wall is not heard, be it solid there or another wall: else a twin among thick walls
      // gathers what it cannot hear.
      const double reach = walls.range_to_wall(disc, (end - disc) / echo.range, echo.range);
      nearest = std::min(
          nearest, reach < echo.range ? std::max(0.0, echo.range - reach - kInWall) : walls.distance_to_wall(end));
      is_behind = is_behind && reach < behind;
    }
    const double hit = nearest / sigma;
    const double wall = std::log(1.0 + kFromWall / (1.0 - kFromWall) * std::exp(-0.5 * hit * hit));
    sum += echo.weight * (is_behind ? wall - kBehindWall : wall);
  }
  return sum;
}

}  // namespace luminav
