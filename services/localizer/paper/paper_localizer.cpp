#include "services/localizer/paper/paper_localizer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kAgreement = 11.34;  // of three degrees of freedom one true pose in a hundred is farther off

bool agree(const PoseBelief& a, const PoseBelief& b) {
  const Eigen::Vector3d off(a.pose.x - b.pose.x, a.pose.y - b.pose.y, wrap_angle(a.pose.theta - b.pose.theta));
  return off.dot((a.covariance + b.covariance).ldlt().solve(off)) <= kAgreement;
}

}  // namespace

PaperLocalizer::PaperLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                               const ErrorParams& errors, const PaperLocalizerParams& params, std::uint64_t seed)
    : map_(building.fixtures),
      view_(robot.camera),
      walls_(walls),
      robot_(robot),
      ceiling_height_(building.ceiling_height),
      errors_(errors),
      params_(params),
      filter_(map_, walls_, params.particles, seed) {}

void PaperLocalizer::add_odometry(const OdometryReading& reading) {
  const OdometryHistory& history = queue_.history();
  if (!history.is_empty() && reading.session != history.newest().session) {
    queue_.restart();
    filter_odometry_.reset();
    give_up("the odometry began anew");
  }
  queue_.add_odometry(reading);
  while (const auto timed = queue_.next()) {
    step(*timed);
  }
}

void PaperLocalizer::add_frame(const SightingFrame& frame) {
  queue_.add_frame(frame);
  while (const auto timed = queue_.next()) {
    step(*timed);
  }
}

void PaperLocalizer::add_guess(const PoseGuess& guess) {
  if (guess.id == guess_id_) {
    return;
  }
  guess_id_ = guess.id;
  if (is_kalman_) {
    if (agree(guess.belief, belief_)) {
      return;
    }
    give_up("a pose was given that is not the one followed");  // the particles of both will tell
  }
  filter_.gather(guess.belief, params_.handover.gathered_share);
}

void PaperLocalizer::step(const FrameQueue::TimedFrame& timed) {
  Pose2 delta;
  if (filter_odometry_) {
    delta = filter_odometry_->odom_from_robot.inverse() * timed.odometry.odom_from_robot;
  }
  filter_odometry_ = timed.odometry;
  odometer_ += std::hypot(delta.x, delta.y);
  if (is_kalman_) {
    predict(belief_, delta, odometry_noise_with_systematics(delta, robot_.wheel_base, errors_));
    step_kalman(timed.frame, timed.odometry);
  } else {
    filter_.predict(delta);
    step_particles(timed.frame);
  }
}

void PaperLocalizer::remember_fixture(const SightingFrame& frame) {
  std::vector<int> near;
  for (const FixtureSighting& sighting : frame.sightings) {
    const Eigen::Vector2d place = clusters_.front().belief.pose * sighting.robot_from_fixture.position();
    near.clear();
    map_.find_near(place, 0.5, near);
    if (!near.empty() &&
        std::find(seen_fixtures_.begin(), seen_fixtures_.end(), near.front()) == seen_fixtures_.end()) {
      seen_fixtures_.push_back(near.front());
    }
  }
}

void PaperLocalizer::step_particles(const SightingFrame& frame) {
  if (frame.sightings.empty() || map_.size() == 0) {
    return;
  }
  filter_.update(frame.sightings);
  has_update_ = true;
  fixture_utime_ = frame.utime;
  odometer_at_fixture_ = odometer_;
  clusters_ = find_clusters(filter_, map_.smallest_spacing(), params_.clusters);
  remember_fixture(frame);
  const HandoverParams& rules = params_.handover;
  const PoseCluster& best = clusters_.front();
  const double second = clusters_.size() > 1 ? clusters_[1].weight : 0.0;
  const bool is_sure = best.weight >= rules.share && second <= rules.runner_up &&
                       position_sigma(best.belief.covariance) <= rules.spread &&
                       std::sqrt(best.belief.covariance(2, 2)) <= rules.heading_spread &&
                       static_cast<int>(seen_fixtures_.size()) >= rules.fixtures &&
                       odometer_ - search_odometer_ >= rules.distance;
  held_ = is_sure ? held_ + 1 : 0;
  reason_ =
      fmt::format("the heaviest of {} clusters holds {:.0f} % of the weight", clusters_.size(), 100.0 * best.weight);
  if (held_ >= rules.held) {
    belief_ = best.belief;
    is_kalman_ = true;
    gate_misses_ = 0;
    absent_ = 0;
    has_nis_ = false;
    reason_ = "one cluster holds nearly all particles";
  }
}

void PaperLocalizer::step_kalman(const SightingFrame& frame, const OdometryReading& odometry) {
  const HandoverParams& rules = params_.handover;
  const double height = std::max(0.2, view_.height_above_camera(ceiling_height_));
  int matched = 0;
  std::vector<int> near;
  for (const FixtureSighting& sighting : frame.sightings) {
    near.clear();
    map_.find_near(belief_.pose * sighting.robot_from_fixture.position(), 1.5, near);
    int nearest = -1;
    Innovation min;
    min.nis = rules.gate;
    for (const int index : near) {
      const Eigen::Matrix3d noise =
          white_sighting_covariance(sighting, map_[index], errors_) +
          systematic_sighting_covariance(sighting, height, odometry.linear, odometry.angular, errors_);
      const Innovation innovation = innovate(belief_, sighting, map_[index], noise);
      if (innovation.nis < min.nis) {
        min = innovation;
        nearest = index;
      }
    }
    if (nearest < 0) {
      continue;
    }
    Eigen::Matrix3d noise =
        white_sighting_covariance(sighting, map_[nearest], errors_) +
        systematic_sighting_covariance(sighting, height, odometry.linear, odometry.angular, errors_);
    if (!sighting.has_theta || symmetry_period(map_[nearest].shape) == 0.0) {
      noise(2, 2) += kNoAngle;
    }
    correct(belief_, min, noise);
    nis_ = has_nis_ ? nis_ + 0.05 * (min.nis / 3.0 - nis_) : min.nis / 3.0;
    has_nis_ = true;
    ++matched;
  }
  near.clear();
  map_.find_near(belief_.pose.position(), view_.radius(ceiling_height_), near);
  const bool is_expected = std::any_of(near.begin(), near.end(), [&](int index) {
    return view_.is_wholly_visible(belief_.pose.inverse() * map_[index].world_from_fixture, map_[index], 0.1);
  });
  if (matched > 0) {
    fixture_utime_ = frame.utime;
    odometer_at_fixture_ = odometer_;
    gate_misses_ = 0;
    absent_ = 0;
    reason_ = "the Kalman filter follows the fixtures";
  } else {
    gate_misses_ += frame.sightings.empty() ? 0 : 1;
    absent_ = is_expected ? absent_ + 1 : absent_;
  }
  if (gate_misses_ >= rules.gate_misses) {
    give_up("the sightings do not fit the pose");
  } else if (absent_ >= rules.absent_frames) {
    give_up("a fixture that ought to be in view is not seen");
  } else if (has_nis_ && nis_ > rules.nis_limit) {
    give_up("the sightings fit the pose worse than they should");
  } else if (odometer_ - odometer_at_fixture_ > rules.blind_distance) {
    give_up(fmt::format("no fixture for {:.0f} m", rules.blind_distance));
  }
}

void PaperLocalizer::give_up(const std::string& why) {
  filter_.scatter();
  if (is_kalman_) {
    PoseBelief wide = belief_;
    wide.covariance += Eigen::Vector3d(0.04, 0.04, 0.03).asDiagonal();
    filter_.gather(wide, params_.handover.gathered_share);
  }
  is_kalman_ = false;
  clusters_.clear();
  seen_fixtures_.clear();
  search_odometer_ = odometer_;
  held_ = 0;
  reason_ = why;
}

LocalizerEstimate PaperLocalizer::estimate() const {
  LocalizerEstimate estimate;
  estimate.reason = map_.size() == 0 ? "the building's file names no fixtures" : reason_;
  estimate.fixture_utime = fixture_utime_;
  estimate.distance_since_fixture = odometer_ - odometer_at_fixture_;
  estimate.has_nis = has_nis_;
  estimate.nis = nis_;
  estimate.initial_pose_id = guess_id_;
  Pose2 ahead;
  if (filter_odometry_ && !queue_.history().is_empty()) {
    ahead = filter_odometry_->odom_from_robot.inverse() * queue_.history().newest().odom_from_robot;
  }
  if (is_kalman_) {
    estimate.state = LocalizerState::kTracking;
    estimate.estimator = EstimatorKind::kKalmanFilter;
    estimate.belief = belief_;
    predict(estimate.belief, ahead, odometry_noise_with_systematics(ahead, robot_.wheel_base, errors_));
  } else if (!clusters_.empty()) {
    estimate.state = LocalizerState::kAmbiguous;
    estimate.estimator = EstimatorKind::kParticleFilter;
    estimate.belief = clusters_.front().belief;
    estimate.belief.pose = estimate.belief.pose * ahead;
    for (const PoseCluster& cluster : clusters_) {
      const Eigen::Vector3d offset(cluster.belief.pose.x - clusters_.front().belief.pose.x,
                                   cluster.belief.pose.y - clusters_.front().belief.pose.y,
                                   wrap_angle(cluster.belief.pose.theta - clusters_.front().belief.pose.theta));
      estimate.belief.covariance += cluster.weight * offset * offset.transpose();
    }
  } else {
    estimate.belief.covariance = unknown_pose_covariance();
  }
  return estimate;
}

std::vector<WeightedPose> PaperLocalizer::hypotheses(std::size_t max) const {
  std::vector<WeightedPose> result;
  if (is_kalman_) {
    return {{estimate().belief.pose, 1.0, position_sigma(belief_.covariance)}};
  }
  for (const PoseCluster& cluster : clusters_) {
    if (result.size() < max) {
      result.push_back({cluster.belief.pose, cluster.weight, position_sigma(cluster.belief.covariance)});
    }
  }
  return result;
}

std::vector<WeightedPose> PaperLocalizer::particles(std::size_t max) const {
  std::vector<WeightedPose> result;
  if (is_kalman_) {
    return result;
  }
  const std::size_t step = std::max<std::size_t>(1, (filter_.size() + max - 1) / std::max<std::size_t>(1, max));
  for (std::size_t i = 0; i < filter_.size(); i += step) {
    result.push_back({filter_.pose(i), filter_.weight(i), 0.0});
  }
  return result;
}

}  // namespace luminav
