#include "services/localizer/hypotheses/object_tracks.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "services/localizer/model/pose_belief.hpp"

namespace luminav {
namespace {

constexpr double kForgetAfter = 4.0;  // [m] driven: odometry drifts some 10 cm and 4 degrees
constexpr double kDrift = 0.15;       // [m] 1-sigma of odometry and cut fixtures between two images of an object
constexpr double kGate = 9.0;         // squared Mahalanobis distance
constexpr double kMaxPitch = 6.0;     // [m] of the lamps of a row
constexpr double kOffRow = 0.35;      // [m] that one of them is seen beside its place in the row

Eigen::Matrix2d position_covariance_in_odom(const FixtureSighting& sighting, const Pose2& odom_from_robot) {
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(odom_from_robot.theta).toRotationMatrix();
  return rotation * sighting.covariance.topLeftCorner<2, 2>() * rotation.transpose();
}

bool extends_row(const ObjectTrack& object, const std::vector<ObjectTrack>& objects) {
  const auto place = [](const ObjectTrack& o) { return o.odom_from_object.position(); };
  const auto is_next = [&](const ObjectTrack& first, const ObjectTrack& last) {
    return first.id != last.id && std::max(first.id, last.id) < object.id &&
           (place(object) - place(last)).norm() < kMaxPitch &&
           (2.0 * place(last) - place(first) - place(object)).norm() < kOffRow;
  };
  return std::any_of(objects.begin(), objects.end(), [&](const ObjectTrack& last) {
    return std::any_of(objects.begin(), objects.end(), [&](const ObjectTrack& first) { return is_next(first, last); });
  });
}

}  // namespace

void ObjectTracks::clear() {
  objects_.clear();
  forgotten_.clear();
}

void ObjectTracks::update(const SightingFrame& frame, const Pose2& odom_from_robot, double odometer) {
  forgotten_.clear();
  const auto is_stale = [&](const ObjectTrack& object) { return odometer - object.odometer > kForgetAfter; };
  std::copy_if(objects_.begin(), objects_.end(), std::back_inserter(forgotten_), is_stale);
  std::erase_if(objects_, is_stale);
  for (ObjectTrack& object : objects_) {
    object.is_visible = false;
  }
  seen_.clear();
  for (const FixtureSighting& sighting : frame.sightings) {
    const Pose2 odom_from_sighting = odom_from_robot * sighting.robot_from_fixture;
    std::size_t nearest = objects_.size();
    double min = kGate;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const ObjectTrack& object = objects_[i];
      if (object.is_visible) {
        continue;  // two sightings of one image are two objects
      }
      const Eigen::Matrix2d covariance = position_covariance_in_odom(sighting, odom_from_robot) +
                                         position_covariance_in_odom(object.best, object.odom_from_robot) +
                                         kDrift * kDrift * Eigen::Matrix2d::Identity();
      const Eigen::Vector2d offset = odom_from_sighting.position() - object.odom_from_object.position();
      const double squared = offset.dot(covariance.inverse() * offset);
      if (squared < min) {
        min = squared;
        nearest = i;
      }
    }
    if (nearest == objects_.size()) {
      objects_.push_back({.id = next_id_++, .best = sighting});
    }
    ObjectTrack& object = objects_[nearest];
    ++object.frames;
    object.is_visible = true;
    object.odometer = odometer;
    const double sharpness = largest_position_sigma(sighting.covariance);
    if (sharpness <= 1.2 * largest_position_sigma(object.best.covariance) + 1e-9) {
      object.best = sighting;
      object.odom_from_object = odom_from_sighting;
      object.odom_from_robot = odom_from_robot;
    }
    seen_.push_back(nearest);
  }
  for (const std::size_t i : seen_) {
    objects_[i].extends_row = objects_[i].extends_row || extends_row(objects_[i], objects_);
  }
}

}  // namespace luminav
