#pragma once

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/wheel_correction.hpp"

namespace luminav {

// What a drive's batch estimates are made of, for those who know the fixtures and those who look for them.

/// An angle [rad] into [-period/2, period/2), for derivatives too.
template <typename T>
T wrapped_residual(const T& angle, double period) {
  return angle - period * ceres::floor(angle / period + 0.5);
}

/// Upper triangle W with W' W the inverse of a covariance.
inline Eigen::Matrix3d whitening(const Eigen::Matrix3d& covariance) {
  return covariance.inverse().llt().matrixU();
}

/// Where a fixture is seen against where it ought to be seen.
struct SightingResidual {
  Eigen::Vector3d measured;
  Pose2 world_from_fixture;
  Eigen::Matrix3d weight;
  Eigen::Vector2d robot_from_camera;
  double height;               // [m] of the ceiling above the camera
  double linear;               // [m/s]
  double angular;              // [rad/s]
  double period;               // [rad] of the fixture's heading; 0 = it has none
  double length;               // [m] of the fixture
  double measured_length;      // [m]
  double length_weight = 0.0;  // [1/m] 0 = not all of it was in view
  bool is_square = false;      // its direction is the mean of its sides'

  template <typename T>
  bool operator()(const T* pose, const T* fixture, const T* camera, T* residual) const {
    using std::cos;
    using std::sin;
    const T c = cos(pose[2]);
    const T s = sin(pose[2]);
    const T dx = world_from_fixture.x + fixture[0] - pose[0];
    const T dy = world_from_fixture.y + fixture[1] - pose[1];
    const T x = c * dx + s * dy;
    const T y = c * dy - s * dx;
    const T theta = world_from_fixture.theta + fixture[2] - pose[2];
    const T px = (x - robot_from_camera.x()) / height;
    const T py = (y - robot_from_camera.y()) / height;
    const T ax = cos(theta);
    const T ay = sin(theta);
    const T along = px * ax + py * ay;
    const T across = py * ax - px * ay;
    const T squared = px * px + py * py;
    const T tilt = camera[0] * px + camera[1] * py;
    // the fields of TrackingFilter::expect
    const T shift_x = height * (camera[0] + tilt * px - camera[2] * py + camera[3] * px + camera[5] * squared * px) +
                      camera[4] * (angular * y - linear);
    const T shift_y = height * (camera[1] + tilt * py + camera[2] * px + camera[3] * py + camera[5] * squared * py) -
                      camera[4] * angular * x;
    const T of_length = across * (camera[0] * ax + camera[1] * ay) + 2.0 * camera[5] * along * across;
    const T of_width = along * (camera[0] * ay - camera[1] * ax) - 2.0 * camera[5] * along * across;
    const T shift_theta = (is_square ? 0.5 * (of_length + of_width) : of_length) + camera[2] - camera[4] * angular;
    const T ex = measured.x() - x - shift_x;
    const T ey = measured.y() - y - shift_y;
    const T et = period == 0.0 ? T(0.0) : wrapped_residual(T(measured.z() - theta - shift_theta), period);
    for (int row = 0; row < 3; ++row) {
      residual[row] = weight(row, 0) * ex + weight(row, 1) * ey + weight(row, 2) * et;
    }
    // how much longer the fields make it
    const T longer =
        camera[3] + tilt + along * (camera[0] * ax + camera[1] * ay) + camera[5] * (squared + 2.0 * along * along);
    residual[3] = length_weight * (measured_length - length * (1.0 + longer));
    return true;
  }
};

/// Two poses against the odometry between them, with the wheels corrected.
struct OdometryResidual {
  std::vector<Pose2> steps;
  double wheel_base;  // [m]
  Eigen::Matrix3d weight;

  template <typename T>
  bool operator()(const T* from, const T* to, const T* wheels, T* residual) const {
    using std::cos;
    using std::sin;
    T x(0.0);
    T y(0.0);
    T theta(0.0);
    for (const Pose2& step : steps) {
      const double distance = (step.x >= 0.0 ? 1.0 : -1.0) * std::hypot(step.x, step.y);
      T true_distance;
      T true_turn;
      WheelCorrection::correct(wheels[0], wheels[1], wheels[2], wheel_base, distance, step.theta, true_distance,
                               true_turn);
      const T heading = theta + 0.5 * true_turn;
      x += true_distance * cos(heading);
      y += true_distance * sin(heading);
      theta += true_turn;
    }
    const T c = cos(from[2]);
    const T s = sin(from[2]);
    const T dx = to[0] - from[0];
    const T dy = to[1] - from[1];
    // in metres of the wheels: a map that shrinks would take their noise with it
    const T ex = (c * dx + s * dy - x) / (1.0 + wheels[0]);
    const T ey = (c * dy - s * dx - y) / (1.0 + wheels[0]);
    const T et = wrapped_residual(T(to[2] - from[2] - theta), 2.0 * kPi);
    for (int row = 0; row < 3; ++row) {
      residual[row] = weight(row, 0) * ex + weight(row, 1) * ey + weight(row, 2) * et;
    }
    return true;
  }
};

template <int kCount>
struct PriorResidual {
  std::array<double, kCount> sigma;
  std::array<double, kCount> expected{};

  template <typename T>
  bool operator()(const T* values, T* residual) const {
    for (int i = 0; i < kCount; ++i) {
      const auto k = static_cast<std::size_t>(i);
      residual[i] = (values[i] - expected[k]) / sigma[k];
    }
    return true;
  }
};

/// Covariance of the motion over steps of odometry, in the frame at their beginning; the wheels' constant errors apart.
Eigen::Matrix3d noise_of_steps(const std::vector<Pose2>& steps, double wheel_base, const ErrorParams& errors);

/// Covariance of a sighting beside the camera's constant errors; `height` [m] of the ceiling above the camera.
Eigen::Matrix3d noise_of_sighting(const FixtureSighting& sighting, const Fixture& fixture, double height,
                                  const ErrorParams& errors);

}  // namespace luminav
