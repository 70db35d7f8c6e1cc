#include "services/localizer/paper/sighting_matcher.hpp"

#include <algorithm>

#include "services/localizer/model/sighting_model.hpp"

namespace luminav {

Eigen::Matrix3d SightingMatcher::noise_of(const FixtureSighting& sighting, const Fixture& fixture,
                                          const OdometryReading& odometry) const {
  return white_sighting_covariance(sighting, fixture, model_.errors) +
         systematic_sighting_covariance(sighting, model_.height_above_camera(), odometry.linear, odometry.angular,
                                        model_.errors);
}

int SightingMatcher::match(const PoseBelief& belief, const FixtureSighting& sighting,
                           const OdometryReading& odometry) const {
  int nearest = -1;
  double min_nis = limits_.gate;
  for (const int index : model_.fixtures.near(belief.pose * sighting.robot_from_fixture.position(), 1.5)) {
    const double nis =
        innovate(belief, sighting, model_.fixtures[index], noise_of(sighting, model_.fixtures[index], odometry)).nis;
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
  for (const int index : model_.fixtures.near(belief.pose.position(), model_.view.radius(model_.ceiling_height))) {
    const Pose2 robot_from_fixture = belief.pose.inverse() * model_.fixtures[index].world_from_fixture;
    if (std::find(matched.begin(), matched.end(), index) == matched.end() &&
        model_.view.is_wholly_visible(robot_from_fixture, model_.fixtures[index], limits_.view_margin)) {
      ++view.absent;
    }
  }
  view.is_in_wall = !model_.walls.is_free(belief.pose.position());
  return view;
}

}  // namespace luminav
