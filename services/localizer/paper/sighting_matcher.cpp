#include "services/localizer/paper/sighting_matcher.hpp"

#include <algorithm>

#include "services/localizer/model/sighting_model.hpp"

namespace luminav {

SightingMatcher::SightingMatcher(const Building& building, const PriorMap& walls, const CameraDescription& camera,
                                 const ErrorParams& errors, const MatchLimits& limits)
    : map_(building.fixtures),
      walls_(walls),
      view_(camera),
      ceiling_height_(building.ceiling_height),
      errors_(errors),
      limits_(limits) {}

Eigen::Matrix3d SightingMatcher::noise_of(const FixtureSighting& sighting, const Fixture& fixture,
                                          const OdometryReading& odometry) const {
  const double height = std::max(0.2, view_.height_above_camera(ceiling_height_));
  return white_sighting_covariance(sighting, fixture, errors_) +
         systematic_sighting_covariance(sighting, height, odometry.linear, odometry.angular, errors_);
}

int SightingMatcher::match(const PoseBelief& belief, const FixtureSighting& sighting,
                           const OdometryReading& odometry) const {
  std::vector<int> near;
  map_.find_near(belief.pose * sighting.robot_from_fixture.position(), 1.5, near);
  int nearest = -1;
  double min_nis = limits_.gate;
  for (const int index : near) {
    const double nis = innovate(belief, sighting, map_[index], noise_of(sighting, map_[index], odometry)).nis;
    if (nis < min_nis) {
      min_nis = nis;
      nearest = index;
    }
  }
  return nearest;
}

ViewEvidence SightingMatcher::compare(const PoseBelief& belief, const FrameQueue::TimedFrame& timed) const {
  ViewEvidence view;
  std::vector<int> matched;
  for (const FixtureSighting& sighting : timed.frame.sightings) {
    const int fixture = match(belief, sighting, timed.odometry);
    (fixture >= 0 ? view.fits : view.misfits) += 1;
    matched.push_back(fixture);
  }
  std::vector<int> near;
  map_.find_near(belief.pose.position(), view_.radius(ceiling_height_), near);
  for (const int index : near) {
    const Pose2 robot_from_fixture = belief.pose.inverse() * map_[index].world_from_fixture;
    if (std::find(matched.begin(), matched.end(), index) == matched.end() &&
        view_.is_wholly_visible(robot_from_fixture, map_[index], limits_.view_margin)) {
      ++view.absent;
    }
  }
  view.is_in_wall = !walls_.is_free(belief.pose.position());
  return view;
}

}  // namespace luminav
