#include "services/localizer/tracking/fixture_matching.hpp"

#include <Eigen/Dense>

namespace luminav {
namespace {

constexpr double kNear = 1.5;  // [m] beyond it no tracked pose explains a sighting

}  // namespace

std::vector<FixtureMatch> match_sightings(const TrackingFilter& filter, const FixtureMap& map,
                                          const SightingFrame& frame, const OdometryReading& odometry) {
  std::vector<FixtureMatch> matches;
  const Pose2 pose = filter.belief().pose;
  std::vector<int> near;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame.sightings[i];
    near.clear();
    map.find_near(pose * sighting.robot_from_fixture.position(), kNear, near);
    for (const int index : near) {
      if (!fits_kind_and_size(sighting, map[index], KindGate{})) {
        continue;
      }
      const Innovation innovation = filter.innovate(sighting, index, map[index], odometry.linear, odometry.angular);
      // fixtures stand metres apart: one that is a little beside its place is still that fixture
      const Eigen::Matrix3d generous = innovation.covariance + kFixtureSurprise.asDiagonal().toDenseMatrix();
      const double nis = innovation.residual.dot(generous.inverse() * innovation.residual);
      if (nis < kMatchGate) {
        matches.push_back({i, index, nis});
      }
    }
  }
  keep_best(matches);
  return matches;
}

}  // namespace luminav
