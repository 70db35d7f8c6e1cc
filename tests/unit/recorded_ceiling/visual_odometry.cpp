#include "tests/unit/recorded_ceiling/visual_odometry.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav::testing {
namespace {

constexpr double kGate = 0.6;                // [m] between a thing and its sighting: a fifth of the fixtures' pitch
constexpr double kGateTurn = radians(20.0);  // [rad]
constexpr int kRemembered = 30;              // images
constexpr double kSightingSigma = 0.05;      // [m]
constexpr double kSightingTurnSigma = 0.03;  // [rad]
constexpr double kMotionSigma = 0.10;        // [m] by which the motion between two images differs from the one before
constexpr double kMotionTurnSigma = 0.05;    // [rad]

}  // namespace

const VisualOdometry::SeenThing* VisualOdometry::thing_at(const Pose2& odom_from_sighting) const {
  const SeenThing* nearest = nullptr;
  for (const SeenThing& thing : things_) {
    const double apart = distance(thing.odom_from_thing, odom_from_sighting);
    const double turn = std::abs(wrap_modulo(thing.odom_from_thing.theta - odom_from_sighting.theta, kPi));
    if (apart < kGate && turn < kGateTurn &&
        (nearest == nullptr || apart < distance(nearest->odom_from_thing, odom_from_sighting))) {
      nearest = &thing;
    }
  }
  return nearest;
}

// Gauss-Newton over the pose, with the constant velocity's prediction as prior.
Pose2 VisualOdometry::align(const Pose2& predicted, const std::vector<FixtureSighting>& sightings) {
  Pose2 pose = predicted;
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix3d information =
        Eigen::Vector3d(1.0 / (kMotionSigma * kMotionSigma), 1.0 / (kMotionSigma * kMotionSigma),
                        1.0 / (kMotionTurnSigma * kMotionTurnSigma))
            .asDiagonal();
    Eigen::Vector3d gradient = information * Eigen::Vector3d(predicted.x - pose.x, predicted.y - pose.y,
                                                             wrap_angle(predicted.theta - pose.theta));
    for (const FixtureSighting& sighting : sightings) {
      const SeenThing* thing = thing_at(predicted * sighting.robot_from_fixture);
      if (thing == nullptr) {
        continue;
      }
      const Pose2 seen = pose * sighting.robot_from_fixture;
      Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
      jacobian(0, 2) = -(seen.y - pose.y);
      jacobian(1, 2) = seen.x - pose.x;
      const Eigen::Vector3d residual(thing->odom_from_thing.x - seen.x, thing->odom_from_thing.y - seen.y,
                                     wrap_modulo(thing->odom_from_thing.theta - seen.theta, kPi));
      const Eigen::Matrix3d weight =
          Eigen::Vector3d(1.0 / (kSightingSigma * kSightingSigma), 1.0 / (kSightingSigma * kSightingSigma),
                          1.0 / (kSightingTurnSigma * kSightingTurnSigma))
              .asDiagonal();
      information += jacobian.transpose() * weight * jacobian;
      gradient += jacobian.transpose() * weight * residual;
    }
    covariance_ = information.inverse();
    const Eigen::Vector3d step = information.ldlt().solve(gradient);
    pose = {pose.x + step.x(), pose.y + step.y(), wrap_angle(pose.theta + step.z())};
  }
  return pose;
}

Pose2 VisualOdometry::step(const std::vector<FixtureSighting>& sightings) {
  ++frame_;
  const Pose2 before = odom_from_robot_;
  odom_from_robot_ = align(before * velocity_, sightings);
  if (frame_ > 1) {
    velocity_ = before.inverse() * odom_from_robot_;
  }
  std::erase_if(things_, [&](const SeenThing& thing) { return frame_ - thing.last_frame > kRemembered; });
  for (const FixtureSighting& sighting : sightings) {
    const Pose2 place = odom_from_robot_ * sighting.robot_from_fixture;
    const SeenThing* known = thing_at(place);
    if (known == nullptr) {
      things_.push_back({place, frame_});
    } else {
      things_[static_cast<std::size_t>(known - things_.data())].last_frame = frame_;
    }
  }
  return odom_from_robot_;
}

}  // namespace luminav::testing
