#include "services/surveyor/survey/survey_graph.hpp"

#include <ceres/ceres.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

#include "services/localizer/calibration/drive_residuals.hpp"
#include "services/surveyor/survey/fixture_rows.hpp"

namespace luminav {
namespace {

constexpr double kLengthSigma = 0.010;    // [m] of a fixture's length in one image
constexpr double kLengthBias = 0.002;     // [m] by which all err alike: a tape, and the detector
constexpr double kBloom = 0.030;          // [m] by which an end may look farther out, in all images of a pass alike
constexpr double kOutlier = 3.0;          // deviations beyond which a residual counts less (Huber)
constexpr double kRegularization = 1e-6;  // [1/rad^2] of the heading that a round fixture has not
constexpr int kMaxIterations = 50;

using Triple = std::array<double, 3>;

Triple to_triple(const Pose2& pose) {
  return {pose.x, pose.y, pose.theta};
}

Pose2 to_pose(const Triple& triple) {
  return {triple[0], triple[1], wrap_angle(triple[2])};
}

/// Whether both ends of a bar are in view. Of what is nearly square, bloom cannot be told from size.
bool shows_length(const FixtureSighting& sighting, const Fixture& kind) {
  return !sighting.clipped && sighting.state != SightingState::kHalf && kind.shape == FixtureShape::kRectangle &&
         kind.length > 1.5 * kind.width;
}

/// A fixture against its place in the file of a known building.
struct KnownResidual {
  Pose2 world_from_fixture;
  KnownAccuracy sigma;
  double period;  // [rad] of its heading; 0 = it has none

  template <typename T>
  bool operator()(const T* fixture, T* residual) const {
    residual[0] = (fixture[0] - world_from_fixture.x) / sigma.position;
    residual[1] = (fixture[1] - world_from_fixture.y) / sigma.position;
    residual[2] =
        period == 0.0 ? T(0.0) : wrapped_residual(T(fixture[2] - world_from_fixture.theta), period) / sigma.heading;
    return true;
  }
};

/// A fixture's heading against the building's.
struct RightAngleResidual {
  double sigma;  // [rad]

  template <typename T>
  bool operator()(const T* fixture, const T* direction, T* residual) const {
    residual[0] = wrapped_residual(T(fixture[2] - direction[0]), 0.5 * kPi) / sigma;
    return true;
  }
};

/// Two fixtures of a row, across it.
struct InLineResidual {
  double turn;   // [rad] of the row from the building's direction
  double sigma;  // [m]

  template <typename T>
  bool operator()(const T* first, const T* second, const T* direction, T* residual) const {
    using std::cos;
    using std::sin;
    const T theta = direction[0] + turn;
    residual[0] = (cos(theta) * (second[1] - first[1]) - sin(theta) * (second[0] - first[0])) / sigma;
    return true;
  }
};

/// A fixture in the middle between its neighbours of a row, along it.
struct EvenlySpacedResidual {
  double turn;   // [rad] of the row from the building's direction
  double sigma;  // [m]

  template <typename T>
  bool operator()(const T* before, const T* middle, const T* behind, const T* direction, T* residual) const {
    using std::cos;
    using std::sin;
    const T theta = direction[0] + turn;
    const T x = middle[0] - 0.5 * (before[0] + behind[0]);
    const T y = middle[1] - 0.5 * (before[1] + behind[1]);
    residual[0] = (cos(theta) * x + sin(theta) * y) / sigma;
    return true;
  }
};

// What several sightings share does not average away, so each of them gets its part of the variance of the mean.

/// [m] of a fixture's length in one image.
double length_sigma_of(const std::vector<FixturePass>& passes, const CeilingKinds& kinds) {
  double count = 0.0;
  for (const FixturePass& pass : passes) {
    const Fixture& kind = kinds.kinds[static_cast<std::size_t>(pass.kind)];
    count +=
        static_cast<double>(std::count_if(pass.sightings.begin(), pass.sightings.end(),
                                          [&](const PassSighting& seen) { return shows_length(seen.sighting, kind); }));
  }
  return std::hypot(kLengthSigma, kLengthBias * std::sqrt(count));
}

/// Whether a file says where the estimate lies.
bool has_known(const SurveyEstimate& estimate) {
  return std::any_of(estimate.fixtures.begin(), estimate.fixtures.end(),
                     [](const SurveyedFixture& fixture) { return fixture.known >= 0; });
}

bool shows_one_end(const FixtureSighting& sighting) {
  return sighting.near_end_visible != sighting.far_end_visible;
}

/// [m^2] of where the middle lies that is told from one end. Bloom moves it towards the robot before it is passed and
/// after: believed more, it would make the whole map smaller.
double one_end_variance_of(const FixturePass& pass) {
  const auto count = std::count_if(pass.sightings.begin(), pass.sightings.end(),
                                   [](const PassSighting& seen) { return shows_one_end(seen.sighting); });
  return kBloom * kBloom * static_cast<double>(count);
}

SightingResidual residual_of(const FixtureSighting& sighting, const KeyFrame& frame, const Fixture& kind,
                             const SurveyModel& model, double length_sigma, double one_end_variance) {
  const CameraMounting& mounting = model.robot.camera.mounting;
  const double height = std::max(0.2, kind.height - mounting.z);
  const Pose2& at = sighting.robot_from_fixture;
  Eigen::Matrix3d noise = noise_of_sighting(sighting, kind, height, model.errors);
  if (shows_one_end(sighting)) {
    const Eigen::Vector2d along(std::cos(at.theta), std::sin(at.theta));
    noise.topLeftCorner<2, 2>() += one_end_variance * along * along.transpose();
  }
  return {{at.x, at.y, at.theta},
          Pose2{},
          whitening(noise),
          {mounting.x, mounting.y},
          height,
          frame.linear,
          frame.angular,
          sighting.has_theta ? symmetry_period(kind.shape) : 0.0,
          kind.length,
          sighting.length,
          frame.has_lengths && shows_length(sighting, kind) ? 1.0 / length_sigma : 0.0,
          kind.shape == FixtureShape::kSquare};
}

}  // namespace

SurveyEstimate estimate_of(const KnownBuilding& known) {
  SurveyEstimate estimate;
  for (std::size_t f = 0; f < known.building.fixtures.size(); ++f) {
    estimate.fixtures.push_back(
        {known.kinds[f], {}, known.building.fixtures[f].world_from_fixture, static_cast<int>(f)});
  }
  return estimate;
}

struct SurveyGraph::Problem {
  std::vector<Triple> poses;
  std::vector<Triple> fixtures;
  Triple wheels{};
  std::array<double, 6> camera{};
  double direction = 0.0;
  ceres::Problem ceres;
};

SurveyGraph::SurveyGraph(const SurveyModel& model, const std::vector<KeyFrame>& frames,
                         const std::vector<FixturePass>& passes)
    : model_(model), frames_(frames), passes_(passes) {}

void SurveyGraph::add_sightings(Problem& problem, const SurveyEstimate& estimate) const {
  const double length_sigma = length_sigma_of(passes_, model_.kinds);
  for (std::size_t f = 0; f < estimate.fixtures.size(); ++f) {
    const Fixture& kind = model_.kinds.kinds[static_cast<std::size_t>(estimate.fixtures[f].kind)];
    for (const int index : estimate.fixtures[f].passes) {
      const FixturePass& pass = passes_[static_cast<std::size_t>(index)];
      const double one_end_variance = one_end_variance_of(pass);
      for (const PassSighting& seen : pass.sightings) {
        const auto frame = static_cast<std::size_t>(seen.frame);
        auto* residual = new SightingResidual(
            residual_of(seen.sighting, frames_[frame], kind, model_, length_sigma, one_end_variance));
        problem.ceres.AddResidualBlock(new ceres::AutoDiffCostFunction<SightingResidual, 4, 3, 3, 6>(residual),
                                       new ceres::HuberLoss(kOutlier), problem.poses[frame].data(),
                                       problem.fixtures[f].data(), problem.camera.data());
      }
    }
  }
}

void SurveyGraph::add_odometry(Problem& problem) const {
  const double wheel_base = model_.robot.wheel_base;
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    if (frames_[i].steps.empty()) {
      continue;
    }
    auto* residual = new OdometryResidual{frames_[i].steps, wheel_base,
                                          whitening(noise_of_steps(frames_[i].steps, wheel_base, model_.errors))};
    problem.ceres.AddResidualBlock(new ceres::AutoDiffCostFunction<OdometryResidual, 3, 3, 3, 3>(residual),
                                   new ceres::HuberLoss(kOutlier), problem.poses[i - 1].data(), problem.poses[i].data(),
                                   problem.wheels.data());
  }
}

void SurveyGraph::add_priors(Problem& problem) const {
  const ErrorParams& errors = model_.errors;
  const WheelCorrection& wheels = model_.wheels;
  problem.ceres.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PriorResidual<3>, 3, 3>(new PriorResidual<3>{
          {errors.wheel_scale, errors.wheel_ratio, errors.wheel_base}, {wheels.scale, wheels.ratio, wheels.base}}),
      nullptr, problem.wheels.data());
  problem.ceres.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual<6>, 6, 6>(new PriorResidual<6>{
                                     {errors.camera_tilt, errors.camera_tilt, errors.camera_yaw, errors.camera_scale,
                                      errors.camera_time_offset, std::max(1e-4, errors.lens_residual)}}),
                                 nullptr, problem.camera.data());
}

void SurveyGraph::add_known(Problem& problem, const SurveyEstimate& estimate) const {
  const auto is_refined = [](const SurveyedFixture& fixture) { return fixture.known >= 0 && !fixture.passes.empty(); };
  const auto refined = std::count_if(estimate.fixtures.begin(), estimate.fixtures.end(), is_refined);
  for (std::size_t f = 0; f < estimate.fixtures.size(); ++f) {
    if (estimate.fixtures[f].known < 0) {
      continue;
    }
    const Fixture& hangs = model_.known->building.fixtures[static_cast<std::size_t>(estimate.fixtures[f].known)];
    const int sharing = is_refined(estimate.fixtures[f]) ? static_cast<int>(refined) : 1;  // others keep their place
    problem.ceres.AddResidualBlock(
        new ceres::AutoDiffCostFunction<KnownResidual, 3, 3>(new KnownResidual{
            hangs.world_from_fixture, accuracy_of(model_.known->building, sharing), symmetry_period(hangs.shape)}),
        new ceres::HuberLoss(kOutlier), problem.fixtures[f].data());
  }
}

void SurveyGraph::add_building(Problem& problem, const SurveyEstimate& estimate, const BuildingPrior& prior) const {
  for (std::size_t f = 0; f < estimate.fixtures.size() && prior.right_angle > 0.0; ++f) {
    const Fixture& kind = model_.kinds.kinds[static_cast<std::size_t>(estimate.fixtures[f].kind)];
    if (kind.shape != FixtureShape::kRound) {
      problem.ceres.AddResidualBlock(
          new ceres::AutoDiffCostFunction<RightAngleResidual, 1, 3, 1>(new RightAngleResidual{prior.right_angle}),
          new ceres::CauchyLoss(1.0), problem.fixtures[f].data(), &problem.direction);
    }
  }
  if (prior.right_angle <= 0.0 || prior.row <= 0.0) {
    return;
  }
  const FixtureRows rows = find_rows(estimate);
  const auto fixture = [&](int index) { return problem.fixtures[static_cast<std::size_t>(index)].data(); };
  for (const RowPair& pair : rows.pairs) {
    problem.ceres.AddResidualBlock(new ceres::AutoDiffCostFunction<InLineResidual, 1, 3, 3, 1>(
                                       new InLineResidual{0.5 * kPi * pair.quarter_turns, prior.row}),
                                   new ceres::CauchyLoss(1.0), fixture(pair.first), fixture(pair.second),
                                   &problem.direction);
  }
  for (const RowTriple& triple : rows.triples) {
    problem.ceres.AddResidualBlock(new ceres::AutoDiffCostFunction<EvenlySpacedResidual, 1, 3, 3, 3, 1>(
                                       new EvenlySpacedResidual{0.5 * kPi * triple.quarter_turns, prior.row}),
                                   new ceres::CauchyLoss(1.0), fixture(triple.before), fixture(triple.middle),
                                   fixture(triple.behind), &problem.direction);
  }
}

std::unique_ptr<SurveyGraph::Problem> SurveyGraph::build(const SurveyEstimate& estimate,
                                                         const BuildingPrior& prior) const {
  auto problem = std::make_unique<Problem>();
  for (const Pose2& pose : estimate.poses) {
    problem->poses.push_back(to_triple(pose));
  }
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    problem->fixtures.push_back(to_triple(fixture.world_from_fixture));
  }
  problem->wheels = estimate.wheels;
  problem->camera = estimate.camera;
  problem->direction = estimate.direction;
  add_sightings(*problem, estimate);
  add_odometry(*problem);
  add_priors(*problem);
  add_building(*problem, estimate, prior);
  add_known(*problem, estimate);
  if (!has_known(estimate)) {
    problem->ceres.AddParameterBlock(problem->poses.front().data(), 3);
    problem->ceres.SetParameterBlockConstant(problem->poses.front().data());
  }
  return problem;
}

SurveyEstimate SurveyGraph::optimise(SurveyEstimate estimate, const BuildingPrior& prior) const {
  if (estimate.poses.empty()) {
    return estimate;
  }
  const std::unique_ptr<Problem> problem = build(estimate, prior);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = kMaxIterations;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem->ceres, &summary);
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    estimate.poses[i] = to_pose(problem->poses[i]);
  }
  for (std::size_t f = 0; f < estimate.fixtures.size(); ++f) {
    estimate.fixtures[f].world_from_fixture = to_pose(problem->fixtures[f]);
  }
  estimate.wheels = problem->wheels;
  estimate.camera = problem->camera;
  estimate.direction = problem->direction;
  estimate.has_converged = summary.IsSolutionUsable();
  return estimate;
}

std::vector<std::vector<double>> SurveyGraph::misfits(const SurveyEstimate& estimate) const {
  std::vector<std::vector<double>> result(passes_.size());
  const double length_sigma = length_sigma_of(passes_, model_.kinds);
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    const Triple place = to_triple(fixture.world_from_fixture);
    for (const int index : fixture.passes) {
      const FixturePass& pass = passes_[static_cast<std::size_t>(index)];
      const double one_end_variance = one_end_variance_of(pass);
      for (const PassSighting& seen : pass.sightings) {
        const auto frame = static_cast<std::size_t>(seen.frame);
        const Triple pose = to_triple(estimate.poses[frame]);
        std::array<double, 4> residual{};
        residual_of(seen.sighting, frames_[frame], model_.kinds.kinds[static_cast<std::size_t>(fixture.kind)], model_,
                    length_sigma, one_end_variance)(pose.data(), place.data(), estimate.camera.data(), residual.data());
        result[static_cast<std::size_t>(index)].push_back(std::hypot(residual[0], residual[1], residual[2]));
      }
    }
  }
  return result;
}

Eigen::MatrixXd SurveyGraph::fixture_covariance(const SurveyEstimate& estimate, const BuildingPrior& prior) const {
  const std::unique_ptr<Problem> problem = build(estimate, prior);
  ceres::Problem::EvaluateOptions options;
  for (Triple& fixture : problem->fixtures) {
    options.parameter_blocks.push_back(fixture.data());
  }
  for (std::size_t i = has_known(estimate) ? 0 : 1; i < problem->poses.size(); ++i) {
    if (problem->ceres.HasParameterBlock(problem->poses[i].data())) {
      options.parameter_blocks.push_back(problem->poses[i].data());
    }
  }
  options.parameter_blocks.push_back(problem->wheels.data());
  options.parameter_blocks.push_back(problem->camera.data());
  if (problem->ceres.HasParameterBlock(&problem->direction)) {
    options.parameter_blocks.push_back(&problem->direction);
  }
  ceres::CRSMatrix rows;
  problem->ceres.Evaluate(options, nullptr, nullptr, nullptr, &rows);
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
      rows.num_rows, rows.num_cols, static_cast<Eigen::Index>(rows.values.size()), rows.rows.data(), rows.cols.data(),
      rows.values.data());
  Eigen::SparseMatrix<double> information = jacobian.transpose() * jacobian;
  for (Eigen::Index i = 0; i < information.rows(); ++i) {
    information.coeffRef(i, i) += kRegularization;
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(information);
  const auto size = static_cast<Eigen::Index>(3 * estimate.fixtures.size());
  Eigen::MatrixXd covariance(size, size);
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(information.rows());
  for (Eigen::Index column = 0; column < size; ++column) {
    unit(column) = 1.0;
    const Eigen::VectorXd solved = factor.solve(unit);
    covariance.col(column) = solved.head(size);
    unit(column) = 0.0;
  }
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace luminav
