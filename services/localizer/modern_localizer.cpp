#include "services/localizer/modern_localizer.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace luminav {
namespace {

constexpr double kMinFit = 0.35;                    // outlines that fit worse are not used
constexpr std::int64_t kCameraSilence = 1'000'000;  // [us] after which hypotheses move on without images
constexpr std::int64_t kMaxExtrapolated = 150'000;  // [us] from the newest odometry, which comes at 10 Hz
constexpr std::size_t kMaxSightings = 12;           // of one image
constexpr int kMaxUnmatched = 3;                // images in a row in which a fixture followed by sight may be missed
constexpr int kMinFrames = 2;                   // images of an object before it tells of the pose: one may be wrong
constexpr double kNear = 1.5;                   // [m] beyond it no tracked pose explains a sighting
constexpr double kMatchGate = 16.27;            // of the normalised innovation squared: chi2(3) at 99.9 %
constexpr double kMovedByHand = 0.05;           // [m] by which one image moves a pose that wheels did not move
constexpr double kTurnedByHand = radians(3.0);  // [rad] likewise

// By how much a fixture may stand beside its place and still be that fixture: 60 mm and 1.5 degrees, and as much for
// the pose: either may be wrong when it comes into view. [m^2, m^2, rad^2]
const Eigen::Vector3d kFixtureSurprise{0.0036, 0.0036, 0.0007};
// What a slip or a bump does before an image shows it: 0.3 m and 10 degrees. [m^2, m^2, rad^2]
const Eigen::Vector3d kUnnoticedMotion{0.09, 0.09, 0.03};
constexpr double kMaxSlip = 0.45;               // [m] farther away, or
constexpr double kMaxBumpTurn = radians(15.0);  // [rad] turned by more, it may as well be anywhere
constexpr double kHungTurned = 0.0012;          // [rad^2] 2 degrees: what hangs elsewhere is parallel to its place

/// By how much better [log] a robot that slipped, which leaves its heading, or was bumped, which turns it, explains a
/// fixture's direction than a fixture hung elsewhere does.
double turn_log_ratio(const Innovation& innovation) {
  const double variance = innovation.covariance(2, 2);
  const double squared = innovation.residual.z() * innovation.residual.z();
  const double hung = variance + kHungTurned;
  const double turned = variance + kUnnoticedMotion.z();
  const double bump = 0.5 * (std::log(hung / turned) + squared / hung - squared / turned);
  return std::log(0.5 + 0.5 * std::exp(bump));
}

}  // namespace

ModernLocalizer::ModernLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                                 const ErrorParams& errors, const ModernLocalizerParams& params)
    : model_(building, walls, robot, errors),
      params_(params),
      bank_(model_, params.hypotheses),
      filter_(model_.height_above_camera(), {robot.camera.mounting.x, robot.camera.mounting.y}, robot.wheel_base,
              errors),
      monitor_(model_, params.rules),
      displacement_(robot.wheel_base),
      supervisor_(model_.fixtures, tracks_, bank_, filter_, monitor_, params.rules),
      motion_(model_.walls, robot.sonar.half_angle),
      echoes_(robot.sonar, params.hypotheses) {}

void ModernLocalizer::add_odometry(const OdometryReading& reading) {
  bank_.begin_step();
  const OdometryHistory& history = queue_.history();
  if (!history.is_empty()) {
    const OdometryReading& last = history.newest();
    if (const std::string why = find_gap(last, reading); !why.empty()) {
      bridge(why, odometry_gap(last, reading));
    }
  }
  queue_.add_odometry(reading);
  while (const auto timed = queue_.next()) {
    step(*timed);
  }
  if (filter_odometry_ && reading.utime - filter_odometry_->utime > kCameraSilence) {
    // no images: keep up with odometry, half a second behind so that a late image still finds its place
    if (const auto behind = history.at(reading.utime - kCameraSilence / 2)) {
      advance(*behind);
      listen(behind->utime);
      bank_.wait();
      bank_.tidy();
      decide({});
      doubt_after_motion();
    }
  }
}

void ModernLocalizer::bridge(const std::string& why, const OdometryGap& gap) {
  queue_.restart();
  displacement_.clear();
  tracks_.clear();
  echoes_.clear();
  motion_.clear();
  filter_odometry_.reset();
  if (supervisor_.has_leader()) {
    filter_.bridge(gap.step, gap.noise);
  }
  if (supervisor_.is_tracking()) {
    supervisor_.suspect({.reason = why,
                         .log_prior = log_prior::kAfterGap,
                         .needed_fixtures = gap.may_be_kidnapped ? params_.rules.enter_fixtures : 1});
  } else {
    bank_.bridge(gap.step, gap.noise);
  }
}

void ModernLocalizer::add_frame(const SightingFrame& frame) {
  bank_.begin_step();
  queue_.add_frame(frame);
  while (const auto timed = queue_.next()) {
    step(*timed);
  }
}

void ModernLocalizer::recall(const PoseBelief& belief) {
  if (supervisor_.has_leader()) {
    return;
  }
  filter_.start(belief);
  supervisor_.suspect({"the pose from before the restart waits for a fixture that confirms it", log_prior::kAfterMiss});
}

void ModernLocalizer::add_guess(const PoseBelief& guess) {
  bank_.begin_step();
  if (supervisor_.is_tracking()) {
    supervisor_.add_rival(guess);
  } else {
    bank_.add_guess(guess, log_prior::kOfGuess);
  }
  bank_.tidy();
  decide({});
}

void ModernLocalizer::advance(const OdometryReading& odometry) {
  if (filter_odometry_) {
    const Pose2 delta = filter_odometry_->odom_from_robot.inverse() * odometry.odom_from_robot;
    odometer_ += std::hypot(delta.x, delta.y);
    echoes_.advance(delta);
    bank_.advance(delta);
    if (supervisor_.has_leader()) {
      filter_.predict(delta);
    }
  }
  filter_odometry_ = odometry;
}

void ModernLocalizer::listen(std::int64_t until_utime) {
  // echoes are placed where the next round begins, and what nobody hears has not been heard
  if (bank_.is_busy() || bank_.hypotheses().empty()) {
    return;
  }
  echoes_.begin_for(bank_.beginnings());
  const std::vector<PlacedEcho> echoes = echoes_.take(until_utime, queue_.history(), bank_.max_echoes());
  if (echoes.empty()) {
    return;
  }
  bank_.listen(echoes);
  if (const auto now = queue_.history().at(until_utime); now && supervisor_.is_tracking()) {
    motion_.listen(echoes, now->odom_from_robot, filter_.belief());
  }
}

SightingFrame ModernLocalizer::usable_sightings(const SightingFrame& frame, const OdometryReading& odometry) const {
  SightingFrame usable = frame;
  usable.sightings.clear();
  for (const FixtureSighting& sighting : frame.sightings) {
    if (sighting.fit >= kMinFit && usable.sightings.size() < kMaxSightings) {
      usable.sightings.push_back(
          model_.view.without_rolling_shutter(sighting, model_.ceiling_height, odometry.linear, odometry.angular));
    }
  }
  return usable;
}

void ModernLocalizer::step(const FrameQueue::TimedFrame& timed) {
  advance(timed.odometry);
  const SightingFrame frame = usable_sightings(timed.frame, timed.odometry);
  tracks_.update(frame, timed.odometry.odom_from_robot, odometer_);
  if (displacement_.look(frame, tracks_, timed.odometry.odom_from_robot)) {
    wait_for_rest(frame, timed.odometry);
    return;
  }
  if (is_displaced_) {
    begin_at_rest();
    return;
  }
  listen(frame.utime);
  bank_.observe(frame, tracks_, timed.odometry, odometer_);
  if (supervisor_.has_leader()) {
    monitor_.allow_kidnapping(!motors_enabled_);
    track(frame, timed.odometry);
  }
  supervisor_.favour_predicting_pose();
  if (!supervisor_.is_tracking()) {
    bank_.seed(tracks_);
  }
  bank_.tidy();
  if (corrections_.utime() == frame.utime) {
    supervisor_.keep_leader_at_filter(frame);
  }
  decide(frame);
  doubt_after_motion();
}

void ModernLocalizer::doubt_after_motion() {
  const std::optional<Pose2> moved = motion_.take();
  if (moved && supervisor_.is_tracking()) {
    supervisor_.suspect(
        {"the sonars hear the walls as if the robot had slipped or been bumped", log_prior::kAfterMiss});
    bank_.add_guess({*moved, filter_.belief().covariance}, log_prior::kAfterMiss);
  }
}

void ModernLocalizer::wait_for_rest(const SightingFrame& frame, const OdometryReading& odometry) {
  images_unmatched_ = is_displaced_ ? images_unmatched_ : 0;
  is_displaced_ = true;
  if (is_followed()) {
    const std::vector<FixtureMatch> matches = find_matches(filter_, frame, odometry);
    images_unmatched_ = matches.empty() ? images_unmatched_ + 1 : 0;
    correct_filter(frame, matches, odometry);
  }
  supervisor_.suspend("the robot is moved otherwise than its wheels turn");
}

bool ModernLocalizer::is_followed() const {
  return supervisor_.has_leader() && images_unmatched_ <= kMaxUnmatched;
}

void ModernLocalizer::begin_at_rest() {
  is_displaced_ = false;
  displacement_.clear();
  echoes_.clear();
  motion_.clear();
  supervisor_.resume(is_followed());
}

void ModernLocalizer::track(const SightingFrame& frame, const OdometryReading& odometry) {
  for (const int fixture : model_.fixtures.doubted()) {
    filter_.doubt(fixture);
  }
  std::vector<FixtureMatch> matches = find_matches(filter_, frame, odometry);
  std::erase_if(matches, [&](const FixtureMatch& match) { return tracks_.seen(match.sighting).frames < kMinFrames; });
  const auto contradiction = monitor_.look(frame, tracks_, matches, filter_.belief(), odometry.odom_from_robot);
  if (contradiction && !supervisor_.is_suspected()) {
    suspect(*contradiction, frame, odometry);
  }
  const Pose2 before = filter_.belief().pose;
  correct_filter(frame, matches, odometry);
  const Pose2 after = filter_.belief().pose;
  if (!motors_enabled_ && supervisor_.is_tracking() && !is_near(before, after, kMovedByHand, kTurnedByHand)) {
    supervisor_.suspect({"the robot was moved by hand while its motors were off", log_prior::kAfterMiss});
  }
}

void ModernLocalizer::suspect(Contradiction contradiction, const SightingFrame& frame,
                              const OdometryReading& odometry) {
  TrackingFilter moved = filter_;
  moved.widen(kUnnoticedMotion);
  const std::vector<FixtureMatch> matches = find_matches(moved, frame, odometry);
  correct(moved, frame, matches, odometry);
  const bool is_fixture = contradiction.misfit && !matches.empty() &&
                          is_near(filter_.belief().pose, moved.belief().pose, kMaxSlip, kMaxBumpTurn);
  if (is_fixture) {
    const FixtureMatch& match = matches.front();
    const double log_ratio =
        motion_.log_ratio(moved.belief().pose, filter_.belief(), odometry.odom_from_robot) +
        turn_log_ratio(filter_.innovate(frame.sightings[match.sighting], match.fixture, model_.fixtures[match.fixture],
                                        odometry.linear, odometry.angular));
    for (const FixtureMatch& hung : matches) {
      filter_.doubt(hung.fixture);
    }
    correct(filter_, frame, matches, odometry);
    filter_.mix_in(moved, 1.0 / (1.0 + std::exp(-log_ratio)));
    if (log_ratio > 0.0) {
      contradiction.misfit.reset();  // that is no fault of the map
    }
  }
  if (is_fixture && !monitor_.may_be_kidnapped()) {
    supervisor_.doubt_map(contradiction);
    monitor_.restart();
  } else {
    supervisor_.suspect(contradiction);
  }
}

std::vector<FixtureMatch> ModernLocalizer::find_matches(const TrackingFilter& filter, const SightingFrame& frame,
                                                        const OdometryReading& odometry) const {
  std::vector<FixtureMatch> matches;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame.sightings[i];
    const Eigen::Vector2d place = filter.belief().pose * sighting.robot_from_fixture.position();
    for (const int index : model_.fixtures.near(place, kNear)) {
      const Fixture& fixture = model_.fixtures[index];
      if (!fits_kind_and_size(sighting, fixture, KindGate{})) {
        continue;
      }
      const Innovation innovation = filter.innovate(sighting, index, fixture, odometry.linear, odometry.angular);
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

std::vector<double> ModernLocalizer::correct(TrackingFilter& filter, const SightingFrame& frame,
                                             const std::vector<FixtureMatch>& matches,
                                             const OdometryReading& odometry) const {
  std::vector<double> nis;
  for (const FixtureMatch& match : matches) {
    const FixtureSighting& sighting = frame.sightings[match.sighting];
    const Fixture& fixture = model_.fixtures[match.fixture];
    if (filter.innovate(sighting, match.fixture, fixture, odometry.linear, odometry.angular).nis > kMatchGate) {
      filter.widen(kFixtureSurprise);
      if (!filter.has_in_view(match.fixture, odometer_)) {
        filter.widen_place(match.fixture, kFixtureSurprise);
      }
    }
    nis.push_back(filter.correct(sighting, match.fixture, fixture, odometry.linear, odometry.angular, odometer_));
  }
  return nis;
}

void ModernLocalizer::correct_filter(const SightingFrame& frame, const std::vector<FixtureMatch>& matches,
                                     const OdometryReading& odometry) {
  if (!matches.empty()) {
    motion_.clear();
  }
  corrections_.add(frame.utime, odometer_, correct(filter_, frame, matches, odometry));
}

void ModernLocalizer::decide(const SightingFrame& frame) {
  // While a round goes on some poses have not seen its image: no more can be said than without one.
  const bool has_image = frame.utime != 0 && !bank_.is_busy();
  if (supervisor_.decide(has_image ? bank_.frame() : SightingFrame{}, distance_since_fixture())) {
    correct_filter(frame, find_matches(filter_, frame, *filter_odometry_), *filter_odometry_);
  }
}

Pose2 ModernLocalizer::since_filter() const {
  return filter_odometry_ && !queue_.history().is_empty()
             ? filter_odometry_->odom_from_robot.inverse() * queue_.history().newest().odom_from_robot
             : Pose2{};
}

void ModernLocalizer::look_ahead(LocalizerEstimate& estimate) const {
  if (queue_.waiting().empty() || !filter_odometry_ || is_displaced_) {
    return;
  }
  const OdometryReading& newest = queue_.history().newest();
  TrackingFilter filter = filter_;
  filter.predict(since_filter());
  OdometryGap ahead;
  for (const SightingFrame& waiting : queue_.waiting()) {
    if (waiting.utime > newest.utime + kMaxExtrapolated) {
      break;
    }
    const Pose2 back = ahead.step.inverse();
    ahead = extrapolate(newest, waiting.utime);
    filter.bridge(back * ahead.step, ahead.noise);
    OdometryReading there = newest;
    there.odom_from_robot = newest.odom_from_robot * ahead.step;
    const SightingFrame frame = usable_sightings(waiting, there);
    const std::vector<FixtureMatch> matches = find_matches(filter, frame, there);
    if (!matches.empty()) {
      correct(filter, frame, matches, there);
      estimate.fixture_utime = waiting.utime;
      estimate.distance_since_fixture = 0.0;
    }
  }
  if (estimate.fixture_utime > newest.utime) {
    filter.bridge(ahead.step.inverse(), ahead.noise);
    estimate.belief = filter.belief();
  }
}

LocalizerEstimate ModernLocalizer::estimate() const {
  LocalizerEstimate estimate;
  estimate.state = supervisor_.state();
  estimate.reason = supervisor_.reason();
  const Pose2 ahead = since_filter();
  corrections_.write_to(estimate, odometer_ + std::hypot(ahead.x, ahead.y));
  if (supervisor_.has_leader()) {
    estimate.estimator = EstimatorKind::kKalmanFilter;
    estimate.belief = filter_.belief_after(ahead);
  } else if (!bank_.hypotheses().empty()) {
    estimate.estimator = EstimatorKind::kHypotheses;
    estimate.belief = bank_.belief_now(0);
    predict(estimate.belief, ahead, odometry_noise(ahead, model_.wheel_base, ErrorParams{}));
  }
  if (estimate.state == LocalizerState::kTracking) {
    look_ahead(estimate);
  } else if (estimate.state == LocalizerState::kAmbiguous) {
    widen_over(hypotheses(200), estimate.belief);
  } else if (estimate.state == LocalizerState::kLost) {
    estimate.estimator = bank_.hypotheses().empty() ? EstimatorKind::kNone : EstimatorKind::kHypotheses;
    estimate.belief.covariance = unknown_pose_covariance();
  }
  return estimate;
}

}  // namespace luminav
