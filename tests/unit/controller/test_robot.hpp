#pragma once

#include <cmath>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/controller/safety/obstacles.hpp"

namespace luminav::testing {

/// A Pioneer P3-DX: outline, limits and two sonar arrays, written out so that unit tests read no file.
inline RobotDescription test_robot() {
  RobotDescription robot;
  robot.footprint = {{0.21, -0.2125}, {0.21, 0.2125}, {-0.301, 0.2125}, {-0.301, -0.2125}};
  const double front[8][3] = {{0.069, 0.136, 90},   {0.114, 0.119, 50},   {0.148, 0.078, 30},   {0.166, 0.027, 10},
                              {0.166, -0.027, -10}, {0.148, -0.078, -30}, {0.114, -0.119, -50}, {0.069, -0.136, -90}};
  const double rear[8][3] = {{-0.157, -0.136, -90},  {-0.203, -0.119, -130}, {-0.237, -0.078, -150},
                             {-0.255, -0.027, -170}, {-0.255, 0.027, 170},   {-0.237, 0.078, 150},
                             {-0.203, 0.119, 130},   {-0.157, 0.136, 90}};
  for (const auto& disc : front) {
    robot.sonar.robot_from_sonar.push_back({disc[0], disc[1], radians(disc[2])});
  }
  for (const auto& disc : rear) {
    robot.sonar.robot_from_sonar.push_back({disc[0], disc[1], radians(disc[2])});
  }
  return robot;
}

/// What stands around the test robot.
inline Obstacles around(const std::vector<ObstaclePoint>& points = {}) {
  return Obstacles(Footprint(test_robot().footprint), points);
}

inline ObstaclePoint obstacle_at(double x, double y, bool is_known = false) {
  return {{x, y}, 0.0, 0.0, is_known};
}

/// Points along a straight wall, 2 cm apart.
inline std::vector<ObstaclePoint> wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool is_known = false) {
  std::vector<ObstaclePoint> points;
  const int steps = std::max(1, static_cast<int>((to - from).norm() / 0.02));
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d point = from + (to - from) * i / steps;
    points.push_back(obstacle_at(point.x(), point.y(), is_known));
  }
  return points;
}

}  // namespace luminav::testing
