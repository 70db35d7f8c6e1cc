#include "services/localizer/paper/paper_localizer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "services/localizer/hypotheses/pose_alternatives.hpp"
#include "services/localizer/model/sighting_model.hpp"

namespace luminav {
namespace {

constexpr double kAgreement = 11.34;  // of three degrees of freedom one true pose in a hundred is farther off

bool agree(const PoseBelief& a, const PoseBelief& b) {
  const Eigen::Vector3d off(a.pose.x - b.pose.x, a.pose.y - b.pose.y, wrap_angle(a.pose.theta - b.pose.theta));
  return off.dot((a.covariance + b.covariance).ldlt().solve(off)) <= kAgreement;
}

/// Whether the robot moved far enough since for an image to say something new.
bool has_moved(const std::optional<Pose2>& since, const Pose2& now, const HandoverParams& params) {
  return !since || !is_near(*since, now, params.step, params.turn);
}

}  // namespace

PaperLocalizer::PaperLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                               const ErrorParams& errors, const PaperLocalizerParams& params, std::uint64_t seed)
    : model_(building, walls, robot, errors),
      matcher_(model_, params.handover.limits),
      params_(params),
      filter_(model_.fixtures, model_.walls, params.particles, seed),
      confidence_(params.confidence) {}

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

void PaperLocalizer::add_guess(const PoseBelief& guess) {
  if (belief_) {
    if (agree(guess, *belief_)) {
      return;
    }
    give_up("a pose was given that is not the one followed");  // the particles of both will tell
    filter_.gather(guess, params_.handover.gathered_share);
    return;
  }
  clusters_.clear();
  candidate_.reset();
  confidence_.restart();  // what was seen so far spoke of another pose
  follow(guess, "a pose was given");
}

/// The Kalman filter starts; until what is seen speaks for the pose it is not trusted.
void PaperLocalizer::follow(const PoseBelief& belief, const std::string& why) {
  belief_ = belief;
  reason_ = why;
}

void PaperLocalizer::step(const FrameQueue::TimedFrame& timed) {
  Pose2 delta;
  if (filter_odometry_) {
    delta = filter_odometry_->odom_from_robot.inverse() * timed.odometry.odom_from_robot;
  }
  filter_odometry_ = timed.odometry;
  odometer_ += std::hypot(delta.x, delta.y);
  if (belief_) {
    predict(*belief_, delta, odometry_noise_with_systematics(delta, model_.wheel_base, model_.errors));
    step_kalman(timed);
  } else {
    pending_ = pending_ * delta;
    for (PoseCluster& cluster : clusters_) {
      cluster.belief.pose = cluster.belief.pose * delta;
    }
    candidate_ = candidate_ ? std::optional<Pose2>(*candidate_ * delta) : std::nullopt;
    step_particles(timed);
  }
}

void PaperLocalizer::step_particles(const FrameQueue::TimedFrame& timed) {
  const HandoverParams& rules = params_.handover;
  const bool sees = !timed.frame.sightings.empty() && model_.fixtures.size() > 0;
  if (has_moved(std::optional<Pose2>(Pose2{}), pending_, rules)) {
    move_particles();
  }
  if (sees && has_moved(update_odom_, timed.odometry.odom_from_robot, rules)) {
    update_odom_ = timed.odometry.odom_from_robot;
    move_particles();
    filter_.update(timed.frame.sightings);
    corrections_.note(timed.frame.utime, odometer_);
    clusters_ = find_clusters(filter_, model_.fixtures.smallest_spacing(), params_.clusters);
    reason_ = fmt::format("the heaviest of {} clusters holds {:.0f} % of the weight, log ratio {:.1f}",
                          clusters_.size(), 100.0 * clusters_.front().weight, confidence_.log_ratio());
  }
  if (!clusters_.empty() && has_moved(view_odom_, timed.odometry.odom_from_robot, rules)) {
    view_odom_ = timed.odometry.odom_from_robot;
    weigh_candidate(timed);
  }
}

/// In steps of a fraction of a metre, so that none jumps over a wall.
void PaperLocalizer::move_particles() {
  filter_.predict(pending_);
  pending_ = {};
}

void PaperLocalizer::weigh_candidate(const FrameQueue::TimedFrame& timed) {
  const HandoverParams& rules = params_.handover;
  const PoseCluster& best = clusters_.front();
  const Pose2& pose = best.belief.pose;
  if (!candidate_ || !is_near(*candidate_, pose, 0.5, radians(20.0))) {
    confidence_.restart();
  }
  candidate_ = pose;
  confidence_.add(matcher_.compare(best.belief, timed));
  const bool is_sharp = position_sigma(best.belief.covariance) <= rules.spread &&
                        std::sqrt(best.belief.covariance(2, 2)) <= rules.heading_spread;
  if (confidence_.is_sure() && is_sharp && best.weight >= rules.share) {
    follow(best.belief, "one cluster holds nearly all the weight and explains what is seen");
  }
}

void PaperLocalizer::step_kalman(const FrameQueue::TimedFrame& timed) {
  const OdometryReading& odometry = timed.odometry;
  if (has_moved(view_odom_, odometry.odom_from_robot, params_.handover)) {
    view_odom_ = odometry.odom_from_robot;
    confidence_.add(matcher_.compare(*belief_, timed));
  }
  for (const FixtureSighting& sighting : timed.frame.sightings) {
    const int index = matcher_.match(*belief_, sighting, odometry);
    if (index < 0) {
      continue;
    }
    const Fixture& fixture = model_.fixtures[index];
    const Eigen::Matrix3d noise = params_.handover.images_per_view * matcher_.noise_of(sighting, fixture, odometry);
    const Innovation innovation = innovate(*belief_, sighting, fixture, noise);
    correct(*belief_, innovation, noise);
    corrections_.add(timed.frame.utime, odometer_, {innovation.nis});
    reason_ = "the Kalman filter follows the fixtures";
  }
  if (confidence_.is_refuted()) {
    give_up("what is seen and what is not speak against the pose");
  } else if (corrections_.distance_since(odometer_) > params_.handover.blind_distance) {
    give_up(fmt::format("no fixture for {:.0f} m", params_.handover.blind_distance));
  }
}

void PaperLocalizer::give_up(const std::string& why) {
  filter_.scatter();
  if (belief_) {
    PoseBelief wide = *belief_;
    wide.covariance += Eigen::Vector3d(0.04, 0.04, 0.03).asDiagonal();
    filter_.gather(wide, params_.handover.gathered_share);
  }
  belief_.reset();
  clusters_.clear();
  candidate_.reset();
  update_odom_.reset();
  pending_ = {};
  confidence_.restart();
  reason_ = why;
}

LocalizerEstimate PaperLocalizer::estimate() const {
  LocalizerEstimate estimate;
  estimate.reason = model_.fixtures.size() == 0 ? "the building's file names no fixtures" : reason_;
  corrections_.write_to(estimate, odometer_);
  Pose2 ahead;
  if (filter_odometry_ && !queue_.history().is_empty()) {
    ahead = filter_odometry_->odom_from_robot.inverse() * queue_.history().newest().odom_from_robot;
  }
  if (belief_) {
    estimate.state = confidence_.log_ratio() > 0.0 ? LocalizerState::kTracking : LocalizerState::kAmbiguous;
    estimate.estimator = EstimatorKind::kKalmanFilter;
    estimate.belief = *belief_;
    predict(estimate.belief, ahead, odometry_noise_with_systematics(ahead, model_.wheel_base, model_.errors));
  } else if (!clusters_.empty()) {
    estimate.state = LocalizerState::kAmbiguous;
    estimate.estimator = EstimatorKind::kParticleFilter;
    estimate.belief = clusters_.front().belief;
    widen_over(hypotheses(clusters_.size()), estimate.belief);
    estimate.belief.pose = estimate.belief.pose * ahead;
  } else {
    estimate.belief.covariance = unknown_pose_covariance();
  }
  return estimate;
}

std::vector<WeightedPose> PaperLocalizer::hypotheses(std::size_t max) const {
  std::vector<WeightedPose> result;
  if (belief_) {
    return {{estimate().belief.pose, 1.0, position_sigma(belief_->covariance)}};
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
  if (belief_) {
    return result;
  }
  const std::size_t step = std::max<std::size_t>(1, (filter_.size() + max - 1) / std::max<std::size_t>(1, max));
  for (std::size_t i = 0; i < filter_.size(); i += step) {
    result.push_back({filter_.pose(i) * pending_, filter_.weight(i), 0.0});
  }
  return result;
}

}  // namespace luminav
