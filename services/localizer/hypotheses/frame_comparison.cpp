#include "services/localizer/hypotheses/frame_comparison.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace luminav {
namespace {

constexpr double kStranger = -2.0;     // likewise of what is in no file, where such things were seen before
constexpr double kMaxLogVolume = 3.0;  // that a fixture costs a pose which does not know where to see it

}  // namespace

FrameComparer::FrameComparer(const SightingFrame& frame, double linear, double angular, const ObservationModel& model,
                             const HypothesisParams& params)
    : frame_(frame), model_(model), params_(params), reach_(model.reach()) {
  systematic_.reserve(frame.sightings.size());
  for (const FixtureSighting& sighting : frame.sightings) {
    systematic_.push_back(
        systematic_sighting_covariance(sighting, model.height_above_camera(), linear, angular, model.errors));
  }
}

Eigen::Matrix3d FrameComparer::noise(std::size_t sighting, int fixture) const {
  Eigen::Matrix3d noise =
      white_sighting_covariance(frame_.sightings[sighting], model_.fixtures[fixture], model_.errors) +
      systematic_[sighting];
  if (model_.fixtures.is_doubted(fixture)) {
    noise += FixtureMap::doubt_variance().asDiagonal();
  }
  return noise;
}

FrameComparison FrameComparer::compare(const PoseBelief& belief) const {
  FrameComparison result;
  result.fixture_of_sighting.assign(frame_.sightings.size(), -1);
  result.log_likelihood.assign(frame_.sightings.size(), params_.misfit);
  result.may_be_unlisted.assign(frame_.sightings.size(), false);
  const std::vector<int> near = model_.fixtures.near(belief.pose.position(), reach_);
  thread_local std::vector<FixtureMatch> pairs;
  pairs.clear();
  find_pairs(belief, near, pairs);
  keep_best(pairs);
  for (const FixtureMatch& pair : pairs) {
    result.fixture_of_sighting[pair.sighting] = pair.fixture;
    result.log_likelihood[pair.sighting] = pair.log_likelihood;
  }
  for (std::size_t i = 0; i < frame_.sightings.size(); ++i) {
    const Eigen::Vector2d place = belief.pose * frame_.sightings[i].robot_from_fixture.position();
    if (result.fixture_of_sighting[i] < 0) {
      const bool is_stranger = model_.fixtures.is_stranger(place);
      result.log_likelihood[i] = is_stranger ? kStranger : params_.misfit;
      result.may_be_unlisted[i] = !is_stranger && !model_.is_complete && !model_.seen.contains(place);
    }
  }
  expect(belief, near, result);
  return result;
}

void FrameComparer::find_pairs(const PoseBelief& belief, const std::vector<int>& near,
                               std::vector<FixtureMatch>& pairs) const {
  for (std::size_t i = 0; i < frame_.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame_.sightings[i];
    const Eigen::Vector2d place = belief.pose * sighting.robot_from_fixture.position();
    for (const int index : near) {
      const Fixture& fixture = model_.fixtures[index];
      if ((fixture.world_from_fixture.position() - place).squaredNorm() > 2.25 ||
          !fits_kind_and_size(sighting, fixture, KindGate{})) {
        continue;
      }
      const Innovation innovation = innovate(belief, sighting, fixture, noise(i, index));
      if (innovation.nis < params_.gate) {
        // a doubted one may be seen in many places: that any pose finds it there must not cost nothing
        const double volume =
            model_.fixtures.is_doubted(index) ? kMaxLogVolume : std::min(kMaxLogVolume, innovation.log_volume);
        pairs.push_back({i, index, innovation.nis, std::max(params_.misfit, -0.5 * innovation.nis - volume)});
      }
    }
  }
}

void FrameComparer::expect(const PoseBelief& belief, const std::vector<int>& near, FrameComparison& result) const {
  const double margin = params_.miss_margin + 2.0 * position_sigma(belief.covariance);
  const Pose2 robot_from_world = belief.pose.inverse();
  const PointTransform to_robot(robot_from_world);
  for (const int index : near) {
    const Fixture& fixture = model_.fixtures[index];
    const Eigen::Vector2d centre = to_robot * fixture.world_from_fixture.position();
    const Pose2 robot_from_fixture{centre.x(), centre.y(),
                                   wrap_angle(robot_from_world.theta + fixture.world_from_fixture.theta)};
    if (model_.fixtures.is_doubted(index) || !model_.view.is_wholly_visible(robot_from_fixture, fixture, margin)) {
      continue;
    }
    const bool something_there =
        std::any_of(frame_.sightings.begin(), frame_.sightings.end(), [&](const FixtureSighting& s) {
          const double offset = distance(s.robot_from_fixture, robot_from_fixture);
          return offset < 0.5 * fixture.length + 0.2 ||
                 (offset < FixtureMap::kMaxOffset && fits_kind_and_size(s, fixture, KindGate{}));
        });
    if (!something_there && !frame_.shows_unlit) {
      continue;  // it may hang there unlit
    }
    result.expected.push_back(index);
    if (!something_there) {
      result.missed.push_back(index);
    }
  }
}

}  // namespace luminav
