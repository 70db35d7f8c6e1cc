#include "services/localizer/localizer_node.hpp"

#include <algorithm>
#include <cmath>
#include <luminav/hypotheses_t.hpp>
#include <luminav/pose_t.hpp>

#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kHypothesesPeriod = 200'000;  // [us]
constexpr std::int64_t kSilence = 1'000'000;         // [us]
constexpr std::size_t kMostHypotheses = 500;         // listed in one message
constexpr std::size_t kMostParticles = 2000;
constexpr int kMostDetections = 200;  // beyond it the detector has gone mad
constexpr double kFarthest = 50.0;    // [m] of a sighting from the robot

bool is_covariance(const double (&values)[9]) {
  return std::all_of(std::begin(values), std::end(values), [](double v) { return std::isfinite(v); }) &&
         values[0] > 0.0 && values[4] > 0.0 && values[8] > 0.0 && values[0] * values[4] - values[1] * values[1] >= 0.0;
}

Eigen::Matrix3d to_matrix(const double (&values)[9]) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 9; ++i) {
    matrix(i / 3, i % 3) = values[i];
  }
  return 0.5 * (matrix + matrix.transpose());
}

bool is_possible(const fixture_detection_t& d) {
  return all_finite({d.x, d.y, d.theta, d.length, d.width, d.fit}) && is_covariance(d.covariance) &&
         std::hypot(d.x, d.y) < kFarthest && d.length > 0.0 && d.length < 20.0 && d.width > 0.0 && d.width < 20.0;
}

FixtureSighting to_sighting(const fixture_detection_t& detection) {
  FixtureSighting sighting;
  sighting.robot_from_fixture = {detection.x, detection.y, wrap_angle(detection.theta)};
  sighting.covariance = to_matrix(detection.covariance);
  sighting.shape = detection.shape == fixture_detection_t::SHAPE_SQUARE  ? FixtureShape::kSquare
                   : detection.shape == fixture_detection_t::SHAPE_ROUND ? FixtureShape::kRound
                                                                         : FixtureShape::kRectangle;
  sighting.state = detection.state == fixture_detection_t::STATE_LIT     ? SightingState::kLit
                   : detection.state == fixture_detection_t::STATE_UNLIT ? SightingState::kUnlit
                   : detection.state == fixture_detection_t::STATE_HALF  ? SightingState::kHalf
                                                                         : SightingState::kUnknown;
  sighting.has_theta = detection.has_theta != 0;
  sighting.length = detection.length;
  sighting.width = detection.width;
  sighting.clipped = detection.clipped != 0;
  sighting.near_end_visible = detection.near_end_visible != 0;
  sighting.far_end_visible = detection.far_end_visible != 0;
  sighting.fit = detection.fit;
  return sighting;
}

}  // namespace

LocalizerNode::LocalizerNode(lcm::LCM& lcm, const LocalizerConfig& config)
    : lcm_(lcm), config_(config), localizer_(make_localizer(config)), subscriber_(lcm) {
  subscriber_.on<odometry_t>(channels::kOdometry, &LocalizerNode::on_odometry, this);
  subscriber_.on<fixture_detections_t>(channels::kFixtureDetections, &LocalizerNode::on_fixture_detections, this);
  subscriber_.on<sonar_t>(channels::kSonar, &LocalizerNode::on_sonar, this);
  subscriber_.on<robot_status_t>(channels::kRobotStatus, &LocalizerNode::on_robot_status, this);
  subscriber_.on<initial_pose_t>(channels::kInitialPose, &LocalizerNode::on_initial_pose, this);
}

void LocalizerNode::on_odometry(const odometry_t& message) {
  if (!all_finite({message.x, message.y, message.theta, message.linear, message.angular})) {
    subscriber_.drop("ODOMETRY: not a number");
    return;
  }
  const StampGuard::Verdict verdict = odometry_stamps_.check(message.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("ODOMETRY: older than the one before");
    return;
  }
  // a stream whose clock went back is a new session, whatever its number says
  if (verdict == StampGuard::Verdict::kNewSession) {
    --odometry_session_;
    detection_stamps_ = {};
    sonar_stamps_ = {};
  }
  last_odometry_ = message.utime;
  localizer_->add_odometry(
      {message.utime, message.session + odometry_session_, odom_from_robot(message), message.linear, message.angular});
  publish_pose(message);
  if (std::abs(message.utime - hypotheses_utime_) >= kHypothesesPeriod) {
    hypotheses_utime_ = message.utime;
    publish_hypotheses(message.utime);
  }
}

void LocalizerNode::on_fixture_detections(const fixture_detections_t& message) {
  if (message.count > kMostDetections) {
    subscriber_.drop("FIXTURE_DETECTIONS: more fixtures than one image can show");
    return;
  }
  if (detection_stamps_.check(message.utime) == StampGuard::Verdict::kOld) {
    subscriber_.drop("FIXTURE_DETECTIONS: older than the one before");
    return;
  }
  last_frame_ = message.utime;
  SightingFrame frame;
  frame.utime = message.utime + static_cast<std::int64_t>(std::lround(1e6 * config_.robot.camera.time_offset));
  for (const fixture_detection_t& detection : message.detections) {
    if (!is_possible(detection)) {
      subscriber_.drop("FIXTURE_DETECTIONS: a detection that cannot be");
    } else if (detection.shape != fixture_detection_t::SHAPE_ELEMENT) {
      frame.sightings.push_back(to_sighting(detection));
    }
  }
  localizer_->add_frame(frame);
}

void LocalizerNode::on_sonar(const sonar_t& message) {
  if (sonar_stamps_.check(message.utime) == StampGuard::Verdict::kOld) {
    subscriber_.drop("SONAR: older than the one before");
    return;
  }
  SonarScan scan;
  scan.utime = message.utime;
  scan.session = message.session;
  for (int i = 0; i < message.count; ++i) {
    const auto disc = static_cast<std::size_t>(i);
    if (message.fresh[disc] != 0 && std::isfinite(message.range[disc])) {
      scan.readings.push_back({i, message.range[disc], message.has_echo[disc] != 0, message.range_utime[disc]});
    }
  }
  localizer_->add_sonar(scan);
}

void LocalizerNode::on_robot_status(const robot_status_t& message) {
  localizer_->add_base_state({message.utime, message.connected != 0, message.motors_enabled != 0});
}

void LocalizerNode::on_initial_pose(const initial_pose_t& message) {
  if (!all_finite({message.x, message.y, message.theta}) || !is_covariance(message.covariance)) {
    subscriber_.drop("INITIAL_POSE: not a pose");
    return;
  }
  localizer_->add_guess(
      {message.id, {{message.x, message.y, wrap_angle(message.theta)}, to_matrix(message.covariance)}});
}

void LocalizerNode::publish_pose(const odometry_t& odometry) {
  const LocalizerEstimate estimate = localizer_->estimate();
  pose_t pose{};
  pose.utime = odometry.utime;
  pose.session = odometry.session;
  pose.sequence = pose_sequence_++;
  pose.state = static_cast<std::int8_t>(estimate.state);
  pose.reason = estimate.reason;
  pose.estimator = static_cast<std::int8_t>(estimate.estimator);
  pose.x = estimate.belief.pose.x;
  pose.y = estimate.belief.pose.y;
  pose.theta = estimate.belief.pose.theta;
  for (int i = 0; i < 9; ++i) {
    pose.covariance[i] = estimate.belief.covariance(i / 3, i % 3);
  }
  pose.linear = odometry.linear;
  pose.angular = odometry.angular;
  pose.fixture_utime = estimate.fixture_utime;
  pose.distance_since_fixture = estimate.distance_since_fixture;
  pose.has_nis = estimate.has_nis ? 1 : 0;
  pose.nis = estimate.nis;
  pose.initial_pose_id = estimate.initial_pose_id;
  lcm_.publish(channels::kPose, &pose);
}

void LocalizerNode::publish_hypotheses(std::int64_t utime) {
  hypotheses_t message{};
  message.utime = utime;
  for (const WeightedPose& pose : localizer_->hypotheses(kMostHypotheses)) {
    message.x.push_back(static_cast<float>(pose.pose.x));
    message.y.push_back(static_cast<float>(pose.pose.y));
    message.theta.push_back(static_cast<float>(pose.pose.theta));
    message.weight.push_back(static_cast<float>(pose.weight));
    message.sigma.push_back(static_cast<float>(pose.position_sigma));
  }
  message.count = static_cast<std::int32_t>(message.x.size());
  for (const WeightedPose& particle : localizer_->particles(kMostParticles)) {
    message.particle_x.push_back(static_cast<float>(particle.pose.x));
    message.particle_y.push_back(static_cast<float>(particle.pose.y));
    message.particle_theta.push_back(static_cast<float>(particle.pose.theta));
    message.particle_weight.push_back(static_cast<float>(particle.weight));
  }
  message.particle_count = static_cast<std::int32_t>(message.particle_x.size());
  lcm_.publish(channels::kHypotheses, &message);
}

Health LocalizerNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped() + localizer_->frames_dropped();
  if (last_odometry_ == 0) {
    health.degraded = true;
    health.reason = "no ODOMETRY yet";
  } else if (last_odometry_ - last_frame_ > kSilence) {
    health.degraded = true;
    health.reason = "no FIXTURE_DETECTIONS for more than a second";
  } else if (subscriber_.dropped() > 0) {
    health.reason = subscriber_.last_reason();
  }
  return health;
}

}  // namespace luminav
