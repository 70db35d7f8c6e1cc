#include "services/localizer/hypotheses/sonar_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr double kFromWall = 0.6;  // share of echoes that come from the building's walls
// That an echo from where the map may hide a wall speaks for the pose: about what one at the right pose does.
constexpr double kUnseen = 0.7;
constexpr double kBehindWall = 0.7;  // that an echo from behind a wall speaks against the pose
// That a wall which faces the disc is not heard: one beam in a hundred is so, and two of one wall by the same cause.
// Both together, doubled as all sonar is, must not decide alone (TrackingRules::first_margin).
constexpr double kThroughWall = 2.9;
constexpr double kFacing = 1.1;   // a wall faces the disc if it is nowhere in the beam this much farther
constexpr double kInWall = 0.05;  // [m] from a wall's face to the middle of its cell, to which distances are
constexpr std::array kAcross = {-0.9, -0.45, 0.0, 0.45, 0.9};  // where a beam is looked at, in half angles

using Reaches = std::array<double, kAcross.size()>;  // [m] to the first wall, from side to side of a beam

/// All of the beam meets a wall, at about a right angle: such a wall echoes surely.
bool faces_wall(const Reaches& reaches) {
  const auto [nearest, farthest] = std::minmax_element(reaches.begin(), reaches.end());
  return *farthest < kFacing * *nearest;
}

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
    double nearest = 1e9;
    Reaches reaches{};
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const Eigen::Vector2d offset(fan[i].x() * axis.x() - fan[i].y() * axis.y(),
                                   fan[i].y() * axis.x() + fan[i].x() * axis.y());
      const Eigen::Vector2d end = world_from_robot * Eigen::Vector2d(echo.disc + offset);
      // What is behind the first wall is not heard, be it solid there or another wall: else a alias among thick walls
      // gathers what it cannot hear.
      reaches[i] = walls.range_to_wall(disc, (end - disc) / echo.range, echo.range);
      if (echo.weight > 0.0) {
        nearest = std::min(nearest, reaches[i] < echo.range ? std::max(0.0, echo.range - reaches[i] - kInWall)
                                                            : walls.distance_to_wall(end));
      }
    }
    const double hit = nearest / sigma;
    double wall = std::log(1.0 + kFromWall / (1.0 - kFromWall) * std::exp(-0.5 * hit * hit));
    // from behind a wall, on all of the beam: only a map that is wrong there explains it
    const double behind = echo.range - 0.3 - 2.0 * sigma;
    const bool is_behind = behind > 0.0 && *std::max_element(reaches.begin(), reaches.end()) < behind;
    wall = !is_behind && walls.may_hide_wall(world_from_robot * echo.end) ? std::max(wall, kUnseen) : wall;
    sum += echo.weight * (is_behind ? wall - kBehindWall : wall);
    sum -= is_behind && faces_wall(reaches) ? echo.passage_weight * kThroughWall : 0.0;
  }
  return sum;
}

}  // namespace luminav
