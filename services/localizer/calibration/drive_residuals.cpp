#include "services/localizer/calibration/drive_residuals.hpp"

#include "services/localizer/model/sighting_model.hpp"

namespace luminav {

Eigen::Matrix3d noise_of_steps(const std::vector<Pose2>& steps, double wheel_base, const ErrorParams& errors) {
  Pose2 sum;
  double distance = 0.0;
  for (const Pose2& step : steps) {
    distance += noise_distance(step, wheel_base);
    sum = sum * step;
  }
  const double heading = errors.odometry_heading * errors.odometry_heading * distance;
  const double position = errors.odometry_position * errors.odometry_position * distance;
  const Eigen::Vector3d lever(-0.5 * sum.y, 0.5 * sum.x, 1.0);
  Eigen::Matrix3d noise = heading * lever * lever.transpose();
  noise.diagonal() += Eigen::Vector3d(position + 1e-8, position + 1e-8, 1e-8);
  return noise;
}

Eigen::Matrix3d noise_of_sighting(const FixtureSighting& sighting, const Fixture& fixture, double height,
                                  const ErrorParams& errors) {
  Eigen::Matrix3d noise = white_sighting_covariance(sighting, fixture, errors);
  // the floor's tilt changes from metre to metre, and several images fall on each
  const double floor = 2.0 * std::pow(height * errors.floor_tilt, 2);
  noise.diagonal() += Eigen::Vector3d(floor, floor, 0.0);
  return noise;
}

}  // namespace luminav
