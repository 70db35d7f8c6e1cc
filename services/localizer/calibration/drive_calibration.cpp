#include "services/localizer/calibration/drive_calibration.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "services/localizer/calibration/drive_residuals.hpp"
#include "services/localizer/model/error_model.hpp"

namespace luminav {
namespace {

constexpr double kLengthSigma = 0.015;  // [m] of a fixture's length in one image: edges err alike in all of them
constexpr double kOutlier = 3.0;        // deviations beyond which a residual counts less (Huber)

using Triple = std::array<double, 3>;
using Camera = std::array<double, 6>;  // tilt x, tilt y, yaw, scale, time, lens: the errors of TrackingFilter's state

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
          known.sighting.clipped || known.sighting.state == SightingState::kHalf ? 0.0 : 1.0 / kLengthSigma,
          fixture.shape == FixtureShape::kSquare};
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

template <std::size_t kCount>
void add_prior(ceres::Problem& problem, std::array<double, kCount>& block, const std::array<double, kCount>& sigma,
               const std::array<double, kCount>& expected = {}) {
  using Residual = PriorResidual<static_cast<int>(kCount)>;
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<Residual, static_cast<int>(kCount), static_cast<int>(kCount)>(
          new Residual{sigma, expected}),
      nullptr, block.data());
}

// The wheels' unknowns are their whole correction, for odometry comes as the wheels told it; the camera's are what is
// left beside its file, for the detections were placed with that.
void add_priors(ceres::Problem& problem, Unknowns& unknowns, const LocalizerConfig& config) {
  const ErrorParams& errors = config.errors;
  add_prior(problem, unknowns.wheels, Triple{errors.wheel_scale, errors.wheel_ratio, errors.wheel_base},
            Triple{config.wheels.scale, config.wheels.ratio, config.wheels.base});
  add_prior(problem, unknowns.camera,
            Camera{errors.camera_tilt, errors.camera_tilt, errors.camera_yaw, errors.camera_scale,
                   errors.camera_time_offset, std::max(1e-4, errors.lens_residual)});
  for (auto& [index, fixture] : unknowns.fixtures) {
    add_prior(problem, fixture, Triple{errors.fixture_position, errors.fixture_position, errors.fixture_heading});
  }
}

/// A block of unknowns as they were found; what the drive says nothing of is known as well as before.
template <std::size_t kCount>
std::array<CalibratedValue, kCount> estimates(ceres::Problem& problem, const std::array<double, kCount>& block,
                                              const std::array<double, kCount>& priors) {
  ceres::Covariance::Options options;
  options.num_threads = 1;
  ceres::Covariance covariance(options);
  std::array<double, kCount * kCount> values{};
  const std::vector<std::pair<const double*, const double*>> blocks = {{block.data(), block.data()}};
  const bool is_told =
      covariance.Compute(blocks, &problem) && covariance.GetCovarianceBlock(block.data(), block.data(), values.data());
  std::array<CalibratedValue, kCount> result;
  for (std::size_t i = 0; i < kCount; ++i) {
    result[i] = {block[i], is_told ? std::sqrt(std::max(0.0, values[i * kCount + i])) : priors[i]};
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
  std::tie(result.wheel_scale, result.wheel_ratio, result.wheel_base) = std::tuple_cat(
      estimates(problem, unknowns.wheels, Triple{errors.wheel_scale, errors.wheel_ratio, errors.wheel_base}));
  std::tie(result.tilt_x, result.tilt_y, result.yaw, result.camera_scale, result.time_offset, std::ignore) =
      std::tuple_cat(estimates(problem, unknowns.camera,
                               Camera{errors.camera_tilt, errors.camera_tilt, errors.camera_yaw, errors.camera_scale,
                                      errors.camera_time_offset, errors.lens_residual}));
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
