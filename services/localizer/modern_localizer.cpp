#include "services/localizer/modern_localizer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "services/localizer/pose_alternatives.hpp"

namespace luminav {
namespace {

constexpr double kLeastFit = 0.35;                  // outlines that fit worse are not used
constexpr std::int64_t kCameraSilence = 1'000'000;  // [us] after which hypotheses move on without images
constexpr double kRefuted = 6.0;                    // log-score behind the best at which a leader is one no more
constexpr std::size_t kMostSightings = 12;          // of one image
constexpr double kSamePlace = 0.5;                  // [m] a guess that near
constexpr double kSameHeading = radians(20.0);      // and so little turned means the tracked pose
constexpr int kSureFrames = 3;                      // images of an object after which it is one
constexpr double kMovedByHand = 0.05;               // [m] by which one image moves a pose that wheels did not move
constexpr double kTurnedByHand = radians(3.0);      // [rad] likewise

}  // namespace

ModernLocalizer::ModernLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                                 const ErrorParams& errors, const ModernLocalizerParams& params)
    : building_(building),
      map_(building.fixtures),
      view_(robot.camera),
      walls_(walls),
      wheel_base_(robot.wheel_base),
      params_(params),
      bank_(map_, view_, walls_, building.ceiling_height, robot.wheel_base, robot.sonar, errors, params.hypotheses),
      filter_(std::max(0.2, building.ceiling_height - robot.camera.mounting.z),
              {robot.camera.mounting.x, robot.camera.mounting.y}, robot.wheel_base, errors, params.tracking),
      watch_(map_, view_, building.ceiling_height, params.rules),
      echoes_(robot.sonar, params.hypotheses.sonar_way, params.hypotheses.sonar_turn) {
  if (map_.size() == 0) {
    reason_ = "the building's file names no fixtures";
  }
}

void ModernLocalizer::add_odometry(const OdometryReading& reading) {
  const OdometryHistory& history = queue_.history();
  if (!history.is_empty()) {
    const OdometryReading& last = history.newest();
    if (const std::string why = find_gap(last, reading); !why.empty()) {
      bridge(why, motion_gap(last, reading));
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
      bank_.tidy();
      decide({});
    }
  }
}

void ModernLocalizer::bridge(const std::string& why, const MotionGap& gap) {
  queue_.restart();
  scene_.clear();
  echoes_.clear();
  filter_odometry_.reset();
  if (leader_id_ != 0) {
    filter_.bridge(gap.step, gap.noise);
  }
  if (state_ == LocalizerState::kTracking) {
    doubt(why, params_.rules.bonus_after_gap);
    needed_fixtures_ = gap.may_be_carried ? params_.rules.enter_fixtures : 1;
  } else {
    bank_.bridge(gap.step, gap.noise);
  }
}

void ModernLocalizer::add_frame(const SightingFrame& frame) {
  queue_.add_frame(frame);
  while (const auto timed = queue_.next()) {
    step(*timed);
  }
}

void ModernLocalizer::add_sonar(const SonarScan& scan) {
  echoes_.add(scan);
}

void ModernLocalizer::add_base_state(const BaseState& state) {
  motors_enabled_ = state.motors_enabled || !state.connected;
}

void ModernLocalizer::recall(const PoseBelief& belief) {
  if (leader_id_ != 0) {
    return;
  }
  filter_.start(belief);
  doubt("the pose from before the restart waits for a fixture that confirms it", params_.rules.bonus_after_miss);
  is_recalled_ = true;
}

void ModernLocalizer::judge_recalled_pose(const std::vector<int>& objects, const std::vector<FixtureMatch>& matches) {
  if (!matches.empty()) {
    is_recalled_ = false;
    return;
  }
  const bool is_contradicted = std::any_of(objects.begin(), objects.end(), [&](int object) {
    return scene_.objects()[static_cast<std::size_t>(object)].frames >= kSureFrames;
  });
  if (is_contradicted) {
    is_recalled_ = false;
    bank_.clear();
    scene_.clear();
    leader_id_ = 0;
    doubt_.clear();
  }
}

void ModernLocalizer::add_guess(const PoseGuess& guess) {
  if (guess.id == guess_id_) {
    return;
  }
  guess_id_ = guess.id;
  if (state_ == LocalizerState::kTracking) {
    add_rival(guess.belief);
  } else {
    bank_.add_guess(guess.belief, params_.rules.guess_bonus);
  }
  bank_.tidy();
  decide({});
}

void ModernLocalizer::add_rival(const PoseBelief& belief) {
  const Hypothesis* held = leader();
  const Pose2 pose = filter_.belief().pose;
  if (held == nullptr || (distance(pose, belief.pose) < kSamePlace &&
                          std::abs(wrap_angle(pose.theta - belief.pose.theta)) < kSameHeading)) {
    return;  // that is where it is held to be
  }
  // as good as the tracked pose for now: what is seen next decides, and until then two poses are possible
  const double total = held->total;
  bank_.add_guess(belief, 0.0);
  Hypothesis& rival = bank_.hypotheses().back();
  rival.bonus = total - rival.settled;
}

void ModernLocalizer::advance(const OdometryReading& odometry) {
  if (filter_odometry_) {
    const Pose2 delta = filter_odometry_->odom_from_robot.inverse() * odometry.odom_from_robot;
    odometer_ += std::hypot(delta.x, delta.y);
    echoes_.advance(delta);
    bank_.advance(delta);
    if (leader_id_ != 0) {
      filter_.predict(delta);
    }
  }
  filter_odometry_ = odometry;
}

void ModernLocalizer::listen(std::int64_t until_utime) {
  const std::vector<PlacedEcho> echoes = echoes_.take(until_utime, queue_.history());
  if (!echoes.empty()) {
    bank_.listen(echoes);
  }
}

SightingFrame ModernLocalizer::usable_sightings(const SightingFrame& frame, const OdometryReading& odometry) const {
  SightingFrame usable;
  usable.utime = frame.utime;
  for (const FixtureSighting& sighting : frame.sightings) {
    if (sighting.fit >= kLeastFit && usable.sightings.size() < kMostSightings) {
      usable.sightings.push_back(
          view_.without_rolling_shutter(sighting, building_.ceiling_height, odometry.linear, odometry.angular));
    }
  }
  return usable;
}

void ModernLocalizer::step(const FrameQueue::TimedFrame& timed) {
  advance(timed.odometry);
  const SightingFrame frame = usable_sightings(timed.frame, timed.odometry);
  const std::vector<int> objects = scene_.update(frame, timed.odometry.odom_from_robot, odometer_);
  listen(frame.utime);
  bank_.observe(frame, objects, scene_, timed.odometry, odometer_);
  if (leader_id_ != 0) {
    watch_.allow_carrying(!motors_enabled_);
    track(frame, objects, timed.odometry);
    favour_what_foretold();
  }
  if (state_ != LocalizerState::kTracking) {
    bank_.seed(scene_, timed.odometry.odom_from_robot);
  }
  bank_.tidy();
  decide(frame);
}

void ModernLocalizer::track(const SightingFrame& frame, const std::vector<int>& objects,
                            const OdometryReading& odometry) {
  const std::vector<FixtureMatch> matches = match_sightings(filter_, map_, frame, odometry, params_.tracking.gate);
  if (is_recalled_) {
    judge_recalled_pose(objects, matches);
    if (leader_id_ == 0) {
      return;
    }
  }
  const auto contradiction = watch_.look(frame, objects, scene_, matches, filter_.belief(), odometry.odom_from_robot,
                                         odometer_ - odometer_at_fixture_, !doubt_.empty());
  if (contradiction) {
    doubt(contradiction->reason, contradiction->bonus);
    may_foretell_ = contradiction->is_misfit;
  }
  const Pose2 before = filter_.belief().pose;
  correct_filter(frame, matches, odometry);
  const Pose2 after = filter_.belief().pose;
  if (!motors_enabled_ && state_ == LocalizerState::kTracking &&
      (distance(before, after) > kMovedByHand || std::abs(wrap_angle(after.theta - before.theta)) > kTurnedByHand)) {
    doubt("the robot was moved by hand while its motors were off", params_.rules.bonus_after_miss);
  }
}

void ModernLocalizer::favour_what_foretold() {
  const auto held = std::find_if(bank_.hypotheses().begin(), bank_.hypotheses().end(),
                                 [&](const Hypothesis& h) { return h.id == leader_id_; });
  if (!may_foretell_ || held == bank_.hypotheses().end() || held->confirmed.empty()) {
    return;
  }
  // A robot put elsewhere sees a fixture where the old pose has one in perhaps one of a hundred cases.
  may_foretell_ = false;
  held->bonus += params_.rules.bonus_when_foretold;
}

void ModernLocalizer::correct_filter(const SightingFrame& frame, const std::vector<FixtureMatch>& matches,
                                     const OdometryReading& odometry) {
  for (const FixtureMatch& match : matches) {
    const Innovation innovation = filter_.innovate(frame.sightings[match.sighting], match.fixture, map_[match.fixture],
                                                   odometry.linear, odometry.angular);
    if (innovation.nis > params_.tracking.gate) {
      filter_.widen(kFixtureSurprise);
    }
    const double nis = filter_.correct(frame.sightings[match.sighting], match.fixture, map_[match.fixture],
                                       odometry.linear, odometry.angular, odometer_);
    nis_ = has_nis_ ? nis_ + 0.02 * (nis / 3.0 - nis_) : nis / 3.0;
    has_nis_ = true;
  }
  if (!matches.empty()) {
    fixture_utime_ = frame.utime;
    odometer_at_fixture_ = odometer_;
  }
  for (Hypothesis& hypothesis : bank_.hypotheses()) {
    if (hypothesis.id == leader_id_) {
      hypothesis.belief = filter_.belief();
    }
  }
}

void ModernLocalizer::doubt(const std::string& why, double bonus) {
  doubt_ = why;
  may_foretell_ = false;
  needed_fixtures_ = 1;
  watch_.reset();
  scene_.clear();
  bank_.clear();
  PoseBelief belief = filter_.belief();
  bank_.add_guess(belief, bonus);
  leader_id_ = bank_.hypotheses().front().id;
  doubted_id_ = leader_id_;
  state_ = LocalizerState::kAmbiguous;
  reason_ = why;
}

const Hypothesis* ModernLocalizer::leader() const {
  const auto found = std::find_if(bank_.hypotheses().begin(), bank_.hypotheses().end(),
                                  [&](const Hypothesis& h) { return h.id == leader_id_; });
  return found == bank_.hypotheses().end() ? nullptr : &*found;
}

double ModernLocalizer::margin() const {
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const double second = all.size() > 1 ? all[1].total : -1e18;
  return all.front().total - std::max(second, bank_.null_score());
}

void ModernLocalizer::decide(const SightingFrame& frame) {
  if (bank_.hypotheses().empty()) {
    leader_id_ = 0;
    doubt_.clear();
    state_ = LocalizerState::kLost;
    reason_ = map_.size() == 0           ? "the building's file names no fixtures"
              : scene_.objects().empty() ? "no fixture seen yet"
                                         : "what is seen fits nowhere in the building";
    return;
  }
  drop_refuted_leader();
  if (begin_anew_if_unexplained(frame)) {
    return;
  }
  if (state_ == LocalizerState::kTracking) {
    judge_tracked_pose();
  } else if (!resume_tracking(frame) && !declare_tracking(frame)) {
    explain_ambiguity();
  }
}

void ModernLocalizer::drop_refuted_leader() {
  if (leader_id_ == 0) {
    return;
  }
  const Hypothesis* held = leader();
  if (held == nullptr || bank_.hypotheses().front().total - held->total > kRefuted) {
    leader_id_ = 0;
    doubt_.clear();
    state_ = LocalizerState::kAmbiguous;
  }
}

bool ModernLocalizer::begin_anew_if_unexplained(const SightingFrame& frame) {
  if (frame.sightings.empty() || state_ == LocalizerState::kTracking) {
    return false;
  }
  const Hypothesis& best = bank_.hypotheses().front();
  // a pose in doubt is not given up for a thing that is no fixture as long as others explain that
  const auto explains = [&](const Hypothesis& h) { return h.last_match == frame.utime; };
  const bool is_explained =
      leader_id_ == 0 ? explains(best) : std::any_of(bank_.hypotheses().begin(), bank_.hypotheses().end(), explains);
  unexplained_run_ = is_explained ? 0 : unexplained_run_ + 1;
  if (unexplained_run_ < params_.rules.restart_frames) {
    return false;
  }
  unexplained_run_ = 0;
  const PoseBelief old = leader_id_ != 0 ? filter_.belief() : best.belief;
  scene_.clear();
  bank_.clear();
  bank_.add_guess(old, 0.0);
  leader_id_ = 0;
  doubt_.clear();
  state_ = LocalizerState::kLost;
  reason_ = "nothing explained what was seen; searching anew";
  return true;
}

void ModernLocalizer::judge_tracked_pose() {
  const TrackingRules& rules = params_.rules;
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const Hypothesis& best = all.front();
  const PoseBelief belief = leader_id_ != 0 ? filter_.belief() : best.belief;
  const double sigma = largest_position_sigma(belief.covariance);
  const double heading_sigma = std::sqrt(belief.covariance(2, 2));
  const double second = all.size() > 1 ? all[1].total : -1e18;
  const double ahead = (leader() != nullptr ? leader()->total : -1e18) -
                       (all.size() > 1 ? (best.id == leader_id_ ? second : best.total) : -1e18);
  if (ahead < rules.leave_margin) {
    state_ = LocalizerState::kAmbiguous;
    reason_ = fmt::format("another of {} poses explains what is seen as well", all.size());
  } else if (sigma > rules.leave_position_sigma || heading_sigma > rules.leave_heading_sigma) {
    state_ = LocalizerState::kAmbiguous;
    wide_ = true;
    reason_ = fmt::format("no fixture for {:.1f} m: the pose is only known to {:.2f} m",
                          odometer_ - odometer_at_fixture_, sigma);
  } else {
    reason_ = fmt::format("one pose explains all that was seen; known to {:.0f} mm and {:.1f} degrees", 1e3 * sigma,
                          degrees(heading_sigma));
  }
}

bool ModernLocalizer::resume_tracking(const SightingFrame& frame) {
  const Hypothesis& best = bank_.hypotheses().front();
  if (!wide_ || leader_id_ == 0 || best.id != leader_id_ || best.last_match != frame.utime || !doubt_.empty() ||
      margin() < params_.rules.leave_margin ||
      largest_position_sigma(filter_.belief().covariance) >= params_.rules.enter_position_sigma) {
    return false;
  }
  wide_ = false;
  state_ = LocalizerState::kTracking;
  return true;
}

bool ModernLocalizer::declare_tracking(const SightingFrame& frame) {
  const TrackingRules& rules = params_.rules;
  const Hypothesis best = bank_.hypotheses().front();
  const int enough_fixtures = best.id == leader_id_ ? needed_fixtures_ : rules.enter_fixtures;
  if (margin() < rules.enter_margin || static_cast<int>(best.confirmed.size()) < enough_fixtures ||
      frame.sightings.empty() || best.last_match != frame.utime ||
      largest_position_sigma(best.belief.covariance) >= rules.enter_position_sigma) {
    return false;
  }
  if (best.id != leader_id_) {
    PoseBelief start = best.belief;
    start.covariance += Eigen::Vector3d(0.01, 0.01, 0.003).asDiagonal();
    filter_.start(start);
    leader_id_ = best.id;
    correct_filter(frame, match_sightings(filter_, map_, frame, *filter_odometry_, params_.tracking.gate),
                   *filter_odometry_);
  }
  watch_.confirm(best.id == doubted_id_);
  is_recalled_ = false;
  wide_ = false;
  doubt_.clear();
  state_ = LocalizerState::kTracking;
  reason_ = fmt::format("one pose explains {} fixtures, all others fail", best.confirmed.size());
  return true;
}

void ModernLocalizer::explain_ambiguity() {
  state_ = LocalizerState::kAmbiguous;
  if (!doubt_.empty()) {
    reason_ = doubt_;
  } else if (!wide_) {
    const std::vector<Hypothesis>& all = bank_.hypotheses();
    const Hypothesis& best = all.front();
    const auto close = std::count_if(
        all.begin(), all.end(), [&](const Hypothesis& h) { return h.total > best.total - params_.rules.enter_margin; });
    reason_ = close > 1 ? fmt::format("{} poses explain what was seen", close)
                        : fmt::format("one pose is left, confirmed by {} fixtures so far", best.confirmed.size());
  }
}

Pose2 ModernLocalizer::since_filter() const {
  return filter_odometry_ && !queue_.history().is_empty()
             ? filter_odometry_->odom_from_robot.inverse() * queue_.history().newest().odom_from_robot
             : Pose2{};
}

LocalizerEstimate ModernLocalizer::estimate() const {
  LocalizerEstimate estimate;
  estimate.state = state_;
  estimate.reason = reason_;
  estimate.fixture_utime = fixture_utime_;
  estimate.has_nis = has_nis_;
  estimate.nis = nis_;
  estimate.initial_pose_id = guess_id_;
  const Pose2 ahead = since_filter();
  estimate.distance_since_fixture = odometer_ - odometer_at_fixture_ + std::hypot(ahead.x, ahead.y);
  if (leader_id_ != 0) {
    estimate.estimator = EstimatorKind::kKalmanFilter;
    estimate.belief = filter_.belief_after(ahead);
  } else if (!bank_.hypotheses().empty()) {
    estimate.estimator = EstimatorKind::kHypotheses;
    estimate.belief = bank_.hypotheses().front().belief;
    predict(estimate.belief, ahead, odometry_noise(ahead, wheel_base_, ErrorParams{}));
  }
  if (state_ == LocalizerState::kAmbiguous) {
    widen_over(hypotheses(200), estimate.belief);
  } else if (state_ == LocalizerState::kLost) {
    estimate.estimator = bank_.hypotheses().empty() ? EstimatorKind::kNone : EstimatorKind::kHypotheses;
    estimate.belief.covariance = unknown_pose_covariance();
  }
  return estimate;
}

std::vector<WeightedPose> ModernLocalizer::hypotheses(std::size_t most) const {
  return weigh(bank_.hypotheses(), since_filter(), most);
}

}  // namespace luminav
