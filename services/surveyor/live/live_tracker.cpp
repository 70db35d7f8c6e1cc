#include "services/surveyor/live/live_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/localizer/model/sighting_model.hpp"

namespace luminav {
namespace {

constexpr double kEstimateSigma = 0.05;            // [m] of the robot beside what it passed lately, by an estimate,
constexpr double kEstimateHeading = radians(0.5);  // [rad] and of its heading
constexpr double kMaxFixtureSigma = 0.15;          // [m] of a fixture that corrects
constexpr double kFixtureSigma = 0.03;             // [m] by which a surveyed fixture is off beside its neighbours,
constexpr double kFixtureHeading = radians(1.0);   // [rad] likewise
constexpr double kGate = 11.34;                    // chi2(3) at 99 %
constexpr double kOtherGate = 30.0;                // within which there must be no other one
constexpr double kMaxOffset = 0.6;                 // [m] half of what lamps hang apart
constexpr double kMaxTurn = 0.5;                   // [rad/s] faster, errors of time become errors of angle
constexpr double kMinSigma = 0.02;                 // [m] looking longer makes it no surer,
constexpr double kMinHeading = radians(0.3);       // [rad] since the same errors stay

Eigen::Matrix3d diagonal(double position, double heading) {
  return Eigen::Vector3d(position * position, position * position, heading * heading).asDiagonal();
}

}  // namespace

void LiveTracker::begin(const Pose2& world_from_robot) {
  wheels_ = model_.wheels;
  fixtures_.clear();
  belief_ = {world_from_robot, diagonal(kEstimateSigma, kEstimateHeading)};
  driven_ = 0.0;
}

void LiveTracker::begin(const LiveEstimate& estimate) {
  begin(estimate.world_from_robot);
  const auto& [scale, ratio, base] = estimate.survey.estimate.wheels;
  wheels_ = {scale, ratio, base};
  for (std::size_t f = 0; f < estimate.survey.fixtures.size(); ++f) {
    const SurveyedFixture& surveyed = estimate.survey.estimate.fixtures[f];
    if (position_sigma(estimate.survey.fixtures[f].covariance) <= kMaxFixtureSigma) {
      fixtures_.push_back(model_.kinds.kinds[static_cast<std::size_t>(surveyed.kind)]);
      fixtures_.back().world_from_fixture = surveyed.world_from_fixture;
    }
  }
}

void LiveTracker::drive(const OdometryReading& before, const OdometryReading& now) {
  const Pose2 step = before.odom_from_robot.inverse() * now.odom_from_robot;
  double distance = 0.0;
  double turn = 0.0;
  WheelCorrection::correct(wheels_.scale, wheels_.ratio, wheels_.base, model_.robot.wheel_base, signed_length(step),
                           step.theta, distance, turn);
  const Pose2 corrected{distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), wrap_angle(turn)};
  predict(belief_, corrected, odometry_noise(corrected, model_.robot.wheel_base, model_.errors));
  driven_ += std::abs(distance);
}

void LiveTracker::look(const SightingFrame& frame, const Pose2& since, double linear, double angular) {
  if (std::abs(angular) > kMaxTurn) {
    return;
  }
  PoseBelief belief = belief_;
  belief.pose = belief.pose * since.inverse();
  bool is_corrected = false;
  for (const FixtureSighting& sighting : frame.sightings) {
    is_corrected |= correct(sighting, linear, angular, belief);
  }
  if (is_corrected) {
    belief_.pose = belief.pose * since;
    belief_.covariance = belief.covariance;
    const Eigen::Vector3d least = diagonal(kMinSigma, kMinHeading).diagonal();
    belief_.covariance.diagonal() = belief_.covariance.diagonal().cwiseMax(least);
  }
}

bool LiveTracker::correct(const FixtureSighting& sighting, double linear, double angular, PoseBelief& belief) const {
  if (sighting.clipped) {
    return false;
  }
  const double height = model_.kinds.ceiling_height - model_.robot.camera.mounting.z;
  const Pose2 seen = belief.pose * sighting.robot_from_fixture;
  std::optional<Innovation> best;
  Eigen::Matrix3d best_noise;
  for (const Fixture& fixture : fixtures_) {
    if (fixture.shape != sighting.shape || distance(fixture.world_from_fixture, seen) > kMaxOffset) {
      continue;
    }
    const Eigen::Matrix3d noise = white_sighting_covariance(sighting, fixture, model_.errors) +
                                  systematic_sighting_covariance(sighting, height, linear, angular, model_.errors) +
                                  diagonal(kFixtureSigma, kFixtureHeading);
    const Innovation innovation = innovate(belief, sighting, fixture, noise);
    if (innovation.nis <= kOtherGate && best) {
      return false;  // either could be meant
    }
    if (innovation.nis <= kOtherGate) {
      best = innovation;
      best_noise = noise;
    }
  }
  if (!best || best->nis > kGate) {
    return false;
  }
  luminav::correct(belief, *best, best_noise);
  return true;
}

}  // namespace luminav
