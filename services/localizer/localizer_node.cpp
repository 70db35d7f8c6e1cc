#include "services/localizer/localizer_node.hpp"

#include <algorithm>
#include <cmath>
#include <luminav/hypotheses_t.hpp>
#include <utility>

#include "services/common/ceiling/detection_conversion.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kHypothesesPeriod = 200'000;  // [us]
constexpr std::int64_t kSilence = 1'000'000;         // [us]
constexpr std::int64_t kMaxAhead = 500'000;          // [us] of an image before the newest odometry
constexpr double kFarthestGuess = 1e5;               // [m] no building is larger
constexpr std::size_t kMaxHypotheses = 500;          // listed in one message
constexpr std::size_t kMaxParticles = 2000;
constexpr int kMaxDetections = 200;  // beyond it the detector has gone mad

}  // namespace

LocalizerNode::LocalizerNode(lcm::LCM& lcm, LocalizerConfig config, std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(std::move(config)),
      localizer_(make_localizer(config_)),
      wheels_(config_.wheels, config_.robot.wheel_base),
      memory_(config_.state_dir, config_.building),
      subscriber_(lcm, key) {
  config_.walls = {};
  subscriber_.on<odometry_t>(channels::kOdometry, &LocalizerNode::on_odometry, this);
  subscriber_.on<fixture_detections_t>(channels::kFixtureDetections, &LocalizerNode::on_fixture_detections, this);
  subscriber_.on<sonar_t>(channels::kSonar, &LocalizerNode::on_sonar, this);
  subscriber_.on<robot_status_t>(channels::kRobotStatus, &LocalizerNode::on_robot_status, this);
  subscriber_.on<initial_pose_t>(channels::kInitialPose, &LocalizerNode::on_initial_pose, this);
}

void LocalizerNode::on_odometry(const odometry_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("ODOMETRY: what no robot measures");
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
    memory_.restart();
  }
  if (verdict == StampGuard::Verdict::kNewSession || message.session != wheels_session_) {
    wheels_.restart();
    wheels_session_ = message.session;
  }
  odometry_ = message;
  const OdometryReading reading{message.utime, message.session, odom_from_robot(message), message.linear,
                                message.angular};
  if (const auto belief = memory_.recall(reading)) {
    localizer_->recall(*belief);
  }
  localizer_->add_odometry({reading.utime, reading.session + odometry_session_,
                            wheels_.correct(reading.odom_from_robot), reading.linear, reading.angular});
  const LocalizerEstimate estimate = localizer_->estimate();
  memory_.remember(reading, estimate);
  publish_pose(estimate);
  if (std::abs(message.utime - hypotheses_utime_) >= kHypothesesPeriod) {
    hypotheses_utime_ = message.utime;
    publish_hypotheses(message.utime);
  }
}

void LocalizerNode::on_fixture_detections(const fixture_detections_t& message) {
  if (message.count > kMaxDetections) {
    subscriber_.drop("FIXTURE_DETECTIONS: more fixtures than one image can show");
    return;
  }
  last_frame_ = odometry_.utime;
  SightingFrame frame;
  frame.utime = message.utime + static_cast<std::int64_t>(std::lround(1e6 * config_.robot.camera.time_offset));
  if (odometry_.utime != 0 && frame.utime - odometry_.utime > kMaxAhead) {
    subscriber_.drop("FIXTURE_DETECTIONS: from the future, seen from ODOMETRY");
    return;
  }
  if (detection_stamps_.check(message.utime) == StampGuard::Verdict::kOld) {
    subscriber_.drop("FIXTURE_DETECTIONS: older than the one before");
    return;
  }
  for (const fixture_detection_t& detection : message.detections) {
    if (!is_possible(detection)) {
      subscriber_.drop("FIXTURE_DETECTIONS: a detection that cannot be");
    } else if (detection.shape != fixture_detection_t::SHAPE_ELEMENT) {
      frame.sightings.push_back(to_sighting(detection));
    }
  }
  frame.shows_unlit = !lamp_pictures_.look(message.utime, message.exposure_us);
  localizer_->add_frame(frame);
  if (odometry_.utime == 0) {
    return;
  }
  const LocalizerEstimate estimate = localizer_->estimate();
  if (estimate.fixture_utime != pose_.fixture_utime || static_cast<std::int8_t>(estimate.state) != pose_.state) {
    publish_pose(estimate);
  }
}

void LocalizerNode::on_sonar(const sonar_t& message) {
  if (sonar_stamps_.check(message.utime) == StampGuard::Verdict::kOld) {
    subscriber_.drop("SONAR: older than the one before");
    return;
  }
  SonarScan scan;
  scan.utime = message.utime;
  for (int i = 0; i < message.count; ++i) {
    const auto disc = static_cast<std::size_t>(i);
    if (message.fresh[disc] != 0 && std::isfinite(message.range[disc])) {
      scan.readings.push_back({i, message.range[disc], message.has_echo[disc] != 0, message.range_utime[disc]});
    }
  }
  localizer_->add_sonar(scan);
}

void LocalizerNode::on_robot_status(const robot_status_t& message) {
  localizer_->set_motors_enabled(message.motors_enabled != 0 || message.connected == 0);
}

void LocalizerNode::on_initial_pose(const initial_pose_t& message) {
  if (!all_finite({message.x, message.y, message.theta}) || std::hypot(message.x, message.y) > kFarthestGuess ||
      !is_covariance(message.covariance)) {
    subscriber_.drop("INITIAL_POSE: not a pose of any building");
    return;
  }
  if (message.id == guess_id_) {
    return;  // repeated until the echo arrives
  }
  if (message.id < guess_id_) {
    subscriber_.drop("INITIAL_POSE from before the last one");
    return;
  }
  guess_id_ = message.id;
  localizer_->add_guess({{message.x, message.y, wrap_angle(message.theta)}, to_matrix(message.covariance)});
}

void LocalizerNode::publish_pose(const LocalizerEstimate& estimate) {
  pose_.utime = odometry_.utime;
  pose_.session = odometry_.session;
  pose_.state = static_cast<std::int8_t>(estimate.state);
  pose_.reason = estimate.reason;
  pose_.estimator = static_cast<std::int8_t>(estimate.estimator);
  pose_.x = estimate.belief.pose.x;
  pose_.y = estimate.belief.pose.y;
  pose_.theta = estimate.belief.pose.theta;
  for (int i = 0; i < 9; ++i) {
    pose_.covariance[i] = estimate.belief.covariance(i / 3, i % 3);
  }
  pose_.linear = odometry_.linear;
  pose_.angular = odometry_.angular;
  pose_.fixture_utime = estimate.fixture_utime;
  pose_.distance_since_fixture = estimate.distance_since_fixture;
  pose_.has_nis = estimate.nis ? 1 : 0;
  pose_.nis = estimate.nis.value_or(0.0);
  pose_.initial_pose_id = guess_id_;
  lcm_.publish(channels::kPose, &pose_);
  ++pose_.sequence;
}

void LocalizerNode::publish_hypotheses(std::int64_t utime) {
  hypotheses_t message{};
  message.utime = utime;
  const auto add = [](const WeightedPose& pose, auto& x, auto& y, auto& theta, auto& weight) {
    x.push_back(static_cast<float>(pose.pose.x));
    y.push_back(static_cast<float>(pose.pose.y));
    theta.push_back(static_cast<float>(pose.pose.theta));
    weight.push_back(static_cast<float>(pose.weight));
  };
  for (const WeightedPose& pose : localizer_->hypotheses(kMaxHypotheses)) {
    add(pose, message.x, message.y, message.theta, message.weight);
    message.sigma.push_back(static_cast<float>(pose.position_sigma));
  }
  message.count = static_cast<std::int32_t>(message.x.size());
  for (const WeightedPose& particle : localizer_->particles(kMaxParticles)) {
    add(particle, message.particle_x, message.particle_y, message.particle_theta, message.particle_weight);
  }
  message.particle_count = static_cast<std::int32_t>(message.particle_x.size());
  lcm_.publish(channels::kHypotheses, &message);
}

Health LocalizerNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped() + localizer_->frames_dropped();
  if (odometry_.utime == 0) {
    health.degraded = true;
    health.reason = "no ODOMETRY yet";
  } else if (odometry_.utime - last_frame_ > kSilence) {
    health.degraded = true;
    health.reason = "no FIXTURE_DETECTIONS for more than a second";
  } else if (odometry_.utime - localizer_->last_frame_used() > kSilence) {
    health.degraded = true;
    health.reason = "no image was used for more than a second: their stamps do not fit ODOMETRY's";
  } else if (memory_.has_failed()) {
    health.reason = "the pose cannot be written to " + config_.state_dir;
  } else if (subscriber_.dropped() > 0) {
    health.reason = subscriber_.last_reason();
  }
  return health;
}

}  // namespace luminav
