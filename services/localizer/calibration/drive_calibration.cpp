#include "services/localizer/calibration/drive_calibration.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/sighting_model.hpp"

namespace luminav {
namespace {

constexpr double kLengthSigma = 0.015;  // [m] of a fixture's length in one image: edges err alike in all of them
constexpr double kOutlier = 3.0;        // deviations beyond which a residual counts less (Huber)

using Triple = std::array<double, 3>;
using Camera = std::array<double, 6>;  // tilt x, tilt y, yaw, scale, time, lens: the errors of TrackingFilter's state

template <typename T>
T wrapped(const T& angle, double period) {
  return angle - period * ceres::floor(angle / period + 0.5);
}

/// Upper triangle W with W' W the inverse of a covariance.
Eigen::Matrix3d whitening(const Eigen::Matrix3d& covariance) {
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
    const T shift_theta =
        across * (camera[0] * ax + camera[1] * ay) + camera[2] - camera[4] * angular + 2.0 * camera[5] * along * across;
    const T ex = measured.x() - x - shift_x;
    const T ey = measured.y() - y - shift_y;
    const T et = period == 0.0 ? T(0.0) : wrapped(T(measured.z() - theta - shift_theta), period);
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
    const T ex = c * dx + s * dy - x;
    const T ey = c * dy - s * dx - y;
    const T et = wrapped(T(to[2] - from[2] - theta), 2.0 * kPi);
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
  if (!sighting.has_theta || symmetry_period(fixture.shape) == 0.0) {
    noise(2, 2) += kNoAngle;
  }
  return noise;
}

/// The unknowns of one drive.
struct Unknowns {
  std::vector<Triple> poses;
  std::map<int, Triple> fixtures;
  Triple wheels{};
  Camera camera{};
};

double add_sightings(ceres::Problem& problem, Unknowns& unknowns, const std::vector<KnownFrame>& frames,
                     const LocalizerConfig& config) {
  const double height = std::max(0.2, config.building.ceiling_height - config.robot.camera.mounting.z);
  double count = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const KnownSighting& known : frames[i].sightings) {
      const Fixture& fixture = config.building.fixtures[static_cast<std::size_t>(known.fixture)];
      const Pose2& seen = known.sighting.robot_from_fixture;
      auto* residual = new SightingResidual{
          {seen.x, seen.y, seen.theta},
          fixture.world_from_fixture,
          whitening(noise_of_sighting(known.sighting, fixture, height, config.errors)),
          {config.robot.camera.mounting.x, config.robot.camera.mounting.y},
          height,
          frames[i].odometry.linear,
          frames[i].odometry.angular,
          known.sighting.has_theta ? symmetry_period(fixture.shape) : 0.0,
          fixture.length,
          known.sighting.length,
          known.sighting.clipped || known.sighting.state == SightingState::kHalf ? 0.0 : 1.0 / kLengthSigma};
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SightingResidual, 4, 3, 3, 6>(residual),
                               new ceres::HuberLoss(kOutlier), unknowns.poses[i].data(),
                               unknowns.fixtures[known.fixture].data(), unknowns.camera.data());
      count += 1.0;
    }
  }
  return count;
}

void add_odometry(ceres::Problem& problem, Unknowns& unknowns, const std::vector<KnownFrame>& frames,
                  const LocalizerConfig& config) {
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].steps.empty()) {
      continue;  // another session of odometry
    }
    auto* residual =
        new OdometryResidual{frames[i].steps, config.robot.wheel_base,
                             whitening(noise_of_steps(frames[i].steps, config.robot.wheel_base, config.errors))};
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OdometryResidual, 3, 3, 3, 3>(residual),
                             new ceres::HuberLoss(kOutlier), unknowns.poses[i - 1].data(), unknowns.poses[i].data(),
                             unknowns.wheels.data());
  }
}

// The wheels' unknowns are their whole correction, for odometry comes as the wheels told it; the camera's are what is
// left beside its file, for the detections were placed with that.
void add_priors(ceres::Problem& problem, Unknowns& unknowns, const LocalizerConfig& config) {
  const ErrorParams& errors = config.errors;
  const Triple wheels{config.wheels.scale, config.wheels.ratio, config.wheels.base};
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual<3>, 3, 3>(new PriorResidual<3>{
                               {errors.wheel_scale, errors.wheel_ratio, errors.wheel_base}, wheels}),
                           nullptr, unknowns.wheels.data());
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual<6>, 6, 6>(new PriorResidual<6>{
                               {errors.camera_tilt, errors.camera_tilt, errors.camera_yaw, errors.camera_scale,
                                errors.camera_time_offset, std::max(1e-4, errors.lens_residual)}}),
                           nullptr, unknowns.camera.data());
  for (auto& [index, fixture] : unknowns.fixtures) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual<3>, 3, 3>(new PriorResidual<3>{
                                 {errors.fixture_position, errors.fixture_position, errors.fixture_heading}}),
                             nullptr, fixture.data());
  }
}

template <std::size_t kCount>
std::array<double, kCount> sigmas(ceres::Problem& problem, const std::array<double, kCount>& block,
                                  const std::array<double, kCount>& priors) {
  ceres::Covariance::Options options;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  std::array<double, kCount> result = priors;
  std::array<double, kCount * kCount> values{};
  const std::vector<std::pair<const double*, const double*>> blocks = {{block.data(), block.data()}};
  if (covariance.Compute(blocks, &problem) &&
      covariance.GetCovarianceBlock(block.data(), block.data(), values.data())) {
    for (std::size_t i = 0; i < kCount; ++i) {
      result[i] = std::sqrt(std::max(0.0, values[i * kCount + i]));
    }
  }
  return result;
}

}  // namespace

DriveCalibration calibrate_drive(const std::vector<KnownFrame>& frames, const LocalizerConfig& config) {
  DriveCalibration result;
  result.frames = frames.size();
  if (frames.size() < 3) {
    return result;
  }
  Unknowns unknowns;
  unknowns.wheels = {config.wheels.scale, config.wheels.ratio, config.wheels.base};
  for (const KnownFrame& frame : frames) {
    unknowns.poses.push_back({frame.world_from_robot.x, frame.world_from_robot.y, frame.world_from_robot.theta});
    for (const KnownSighting& known : frame.sightings) {
      unknowns.fixtures[known.fixture] = {};
    }
    for (const Pose2& step : frame.steps) {
      result.distance += std::hypot(step.x, step.y);
    }
  }
  ceres::Problem problem;
  result.sightings = static_cast<std::size_t>(add_sightings(problem, unknowns, frames, config));
  add_odometry(problem, unknowns, frames, config);
  add_priors(problem, unknowns, config);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = 60;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  result.has_converged = summary.termination_type == ceres::CONVERGENCE;
  result.residual = std::sqrt(2.0 * summary.final_cost /
                              std::max(1.0, static_cast<double>(summary.num_residuals - summary.num_parameters)));
  const ErrorParams& errors = config.errors;
  const Triple wheel_sigmas =
      sigmas(problem, unknowns.wheels, Triple{errors.wheel_scale, errors.wheel_ratio, errors.wheel_base});
  const Camera camera_sigmas = sigmas(problem, unknowns.camera,
                                      Camera{errors.camera_tilt, errors.camera_tilt, errors.camera_yaw,
                                             errors.camera_scale, errors.camera_time_offset, errors.lens_residual});
  result.wheel_scale = {unknowns.wheels[0], wheel_sigmas[0]};
  result.wheel_ratio = {unknowns.wheels[1], wheel_sigmas[1]};
  result.wheel_base = {unknowns.wheels[2], wheel_sigmas[2]};
  result.tilt_x = {unknowns.camera[0], camera_sigmas[0]};
  result.tilt_y = {unknowns.camera[1], camera_sigmas[1]};
  result.yaw = {unknowns.camera[2], camera_sigmas[2]};
  result.camera_scale = {unknowns.camera[3], camera_sigmas[3]};
  result.time_offset = {unknowns.camera[4], camera_sigmas[4]};
  result.lens = {unknowns.camera[5], camera_sigmas[5]};
  return result;
}

RobotDescription apply(const DriveCalibration& calibration, const RobotDescription& robot, double ceiling_height) {
  RobotDescription calibrated = robot;
  CameraMounting& mounting = calibrated.camera.mounting;
  // The picture is shifted the other way than the camera is tilted: pitch turns the axis of view to +x, roll to -y,
  // both before the yaw.
  const double c = std::cos(mounting.yaw);
  const double s = std::sin(mounting.yaw);
  mounting.pitch -= c * calibration.tilt_x.value + s * calibration.tilt_y.value;
  mounting.roll += c * calibration.tilt_y.value - s * calibration.tilt_x.value;
  mounting.yaw -= calibration.yaw.value;
  mounting.z = ceiling_height - (ceiling_height - mounting.z) / (1.0 + calibration.camera_scale.value);
  calibrated.camera.time_offset += calibration.time_offset.value;
  return calibrated;
}

}  // namespace luminav
