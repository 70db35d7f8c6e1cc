#include "services/surveyor/survey/wheel_guess.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kHeadingNoise = radians(0.7);  // [rad] of a pass: two sightings, and odometry's own between them
constexpr double kRatioSigma = 0.02;            // fraction: wheels that nobody measured
constexpr double kBaseSigma = 0.05;             // fraction
constexpr int kRounds = 5;                      // of reweighting

/// Motion that the wheels told between two sightings, and by how much the robot turned more than that.
struct TurnEquation {
  double distance = 0.0;  // [m]
  double turn = 0.0;      // [rad]
  double excess = 0.0;    // [rad]
};

std::vector<TurnEquation> turn_equations(const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes,
                                         double wheel_base, const WheelCorrection& known) {
  std::vector<TurnEquation> equations;
  for (const FixturePass& pass : passes) {
    const PassSighting* first = nullptr;
    const PassSighting* last = nullptr;
    for (const PassSighting& seen : pass.sightings) {
      if (seen.sighting.has_theta) {
        first = first == nullptr ? &seen : first;
        last = &seen;
      }
    }
    if (first == last) {
      continue;
    }
    TurnEquation equation;
    double corrected = 0.0;
    for (int i = first->frame + 1; i <= last->frame; ++i) {
      for (const Pose2& step : frames[static_cast<std::size_t>(i)].steps) {
        double distance = 0.0;
        double turn = 0.0;
        WheelCorrection::correct(known.scale, known.ratio, known.base, wheel_base, signed_length(step), step.theta,
                                 distance, turn);
        equation.distance += distance;
        equation.turn += turn;
      }
    }
    corrected = equation.turn;
    const double seen =
        first->sighting.robot_from_fixture.theta - last->sighting.robot_from_fixture.theta;  // turn of the robot
    equation.excess = wrap_modulo(seen - corrected, symmetry_period(first->sighting.shape));
    equations.push_back(equation);
  }
  return equations;
}

}  // namespace

WheelCorrection guess_wheels(const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes,
                             double wheel_base, const WheelCorrection& known) {
  const std::vector<TurnEquation> equations = turn_equations(frames, passes, wheel_base, known);
  // excess = ratio / wheel_base * distance - base * turn
  Eigen::Vector2d solution = Eigen::Vector2d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d information =
        Eigen::Vector2d(1.0 / (kRatioSigma * kRatioSigma), 1.0 / (kBaseSigma * kBaseSigma)).asDiagonal();
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const TurnEquation& equation : equations) {
      const Eigen::Vector2d row(equation.distance / wheel_base, -equation.turn);
      const double residual = std::abs(equation.excess - row.dot(solution)) / kHeadingNoise;
      const double weight = std::min(1.0, 1.0 / std::max(1e-9, residual)) / (kHeadingNoise * kHeadingNoise);
      information += weight * row * row.transpose();
      sum += weight * equation.excess * row;
    }
    solution = information.ldlt().solve(sum);
  }
  return {known.scale, known.ratio + solution(0), known.base + solution(1)};
}

std::vector<Pose2> dead_reckoning(const std::vector<KeyFrame>& frames, double wheel_base,
                                  const WheelCorrection& wheels) {
  std::vector<Pose2> poses;
  for (const KeyFrame& frame : frames) {
    Pose2 pose = frame.steps.empty() ? Pose2{} : poses.back();
    for (const Pose2& step : frame.steps) {
      double distance = 0.0;
      double turn = 0.0;
      WheelCorrection::correct(wheels.scale, wheels.ratio, wheels.base, wheel_base, signed_length(step), step.theta,
                               distance, turn);
      pose = pose * Pose2{distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), wrap_angle(turn)};
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace luminav
