#include "services/localizer/modern_localizer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kLeastFit = 0.35;                  // outlines that fit worse are not used
constexpr double kFastest = 3.0;                    // [m/s] beyond it odometry has jumped, no robot of ours drives so
constexpr std::int64_t kCameraSilence = 1'000'000;  // [us] after which hypotheses move on without images
const Eigen::Vector3d kSurprise(0.0036, 0.0036, 0.0007);  // [m^2, m^2, rad^2] 60 mm and 1.5 degrees
constexpr std::size_t kMostSightings = 12;                // of one image
constexpr std::size_t kMostEchoes = 64;

}  // namespace

ModernLocalizer::ModernLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                                 const ErrorParams& errors, const ModernLocalizerParams& params)
    : building_(building),
      map_(building.fixtures),
      view_(robot.camera),
      walls_(walls),
      robot_(robot),
      params_(params),
      bank_(map_, view_, walls_, building.ceiling_height, robot.wheel_base, robot.sonar, errors, params.hypotheses),
      filter_(std::max(0.2, building.ceiling_height - robot.camera.mounting.z),
              {robot.camera.mounting.x, robot.camera.mounting.y}, robot.wheel_base, errors, params.tracking) {
  if (map_.size() == 0) {
    reason_ = "the building's file names no fixtures";
  }
}

void ModernLocalizer::add_odometry(const OdometryReading& reading) {
  const OdometryHistory& history = queue_.history();
  if (!history.is_empty()) {
    const OdometryReading& last = history.newest();
    const double elapsed = 1e-6 * static_cast<double>(reading.utime - last.utime);
    if (reading.session != last.session) {
      relative_motion_lost("the odometry began anew");
    } else if (distance(reading.odom_from_robot, last.odom_from_robot) > 0.3 + kFastest * elapsed) {
      relative_motion_lost("the odometry jumped");
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

void ModernLocalizer::relative_motion_lost(const std::string& why) {
  queue_.restart();
  scene_.clear();
  echoes_.clear();
  filter_odometry_.reset();
  if (leader_id_ != 0) {
    // most likely the robot stood still: keep the pose, but do not trust it before something confirms it
    PoseBelief belief = filter_.belief();
    belief.covariance += Eigen::Vector3d(0.04, 0.04, 0.03).asDiagonal();
    filter_.start(belief);
    doubt(why, params_.rules.bonus_after_miss);
  } else {
    bank_.clear();
    state_ = LocalizerState::kLost;
    reason_ = why;
  }
}

void ModernLocalizer::add_frame(const SightingFrame& frame) {
  queue_.add_frame(frame);
  while (const auto timed = queue_.next()) {
    step(*timed);
  }
}

void ModernLocalizer::add_sonar(const SonarScan& scan) {
  for (const SonarEcho& reading : scan.readings) {
    if (reading.has_echo && reading.disc >= 0 &&
        reading.disc < static_cast<int>(robot_.sonar.robot_from_sonar.size()) &&
        reading.range >= robot_.sonar.minimum_range && reading.range < 0.9 * robot_.sonar.maximum_range) {
      echoes_.push_back(reading);
    }
  }
  if (echoes_.size() > kMostEchoes) {
    echoes_.erase(echoes_.begin(), echoes_.end() - kMostEchoes);
  }
}

void ModernLocalizer::add_base_state(const BaseState&) {}

void ModernLocalizer::add_guess(const PoseGuess& guess) {
  if (guess.id == guess_id_) {
    return;
  }
  guess_id_ = guess.id;
  if (state_ != LocalizerState::kTracking) {
    bank_.add_guess(guess.belief, params_.rules.guess_bonus);
    bank_.tidy();
    decide({});
  }
}

void ModernLocalizer::advance(const OdometryReading& odometry) {
  if (filter_odometry_) {
    const Pose2 delta = filter_odometry_->odom_from_robot.inverse() * odometry.odom_from_robot;
    const double way = std::hypot(delta.x, delta.y);
    odometer_ += way;
    way_since_sonar_ += way;
    turn_since_sonar_ += std::abs(delta.theta);
    bank_.advance(delta);
    if (leader_id_ != 0) {
      filter_.predict(delta);
    }
  }
  filter_odometry_ = odometry;
}

void ModernLocalizer::listen(std::int64_t until_utime) {
  if (way_since_sonar_ < params_.hypotheses.sonar_way && turn_since_sonar_ < params_.hypotheses.sonar_turn) {
    return;
  }
  const auto now = queue_.history().at(until_utime);
  if (!now) {
    return;
  }
  std::vector<HypothesisBank::Echo> echoes;
  std::vector<bool> has_disc(robot_.sonar.robot_from_sonar.size(), false);
  for (auto reading = echoes_.rbegin(); reading != echoes_.rend(); ++reading) {
    const auto disc = static_cast<std::size_t>(reading->disc);
    const auto then = queue_.history().at(reading->utime);
    if (!then || reading->utime > until_utime || until_utime - reading->utime > 1'000'000 || has_disc[disc]) {
      continue;
    }
    has_disc[disc] = true;  // the newest of each disc
    const Pose2 now_from_sonar =
        now->odom_from_robot.inverse() * then->odom_from_robot * robot_.sonar.robot_from_sonar[disc];
    echoes.push_back(
        {now_from_sonar.position(), now_from_sonar * Eigen::Vector2d(reading->range, 0.0), reading->range});
  }
  if (echoes.size() < 3) {
    return;
  }
  std::erase_if(echoes_, [&](const SonarEcho& r) { return r.utime <= until_utime; });
  way_since_sonar_ = 0.0;
  turn_since_sonar_ = 0.0;
  bank_.listen(echoes);
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
    track(frame, objects, timed.odometry);
  }
  if (state_ != LocalizerState::kTracking) {
    bank_.seed(scene_, timed.odometry.odom_from_robot);
  }
  bank_.tidy();
  decide(frame);
}

std::vector<ModernLocalizer::Match> ModernLocalizer::match(const SightingFrame& frame,
                                                           const OdometryReading& odometry) const {
  std::vector<Match> candidates;
  const Pose2 pose = filter_.belief().pose;
  std::vector<int> near;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame.sightings[i];
    near.clear();
    map_.find_near(pose * sighting.robot_from_fixture.position(), 1.5, near);
    for (const int index : near) {
      if (!fits_kind_and_size(sighting, map_[index], KindGate{})) {
        continue;
      }
      const Innovation innovation = filter_.innovate(sighting, index, map_[index], odometry.linear, odometry.angular);
      // fixtures stand metres apart: one that is a little beside its place is still that fixture
      const Eigen::Matrix3d generous = innovation.covariance + kSurprise.asDiagonal().toDenseMatrix();
      const double nis = innovation.residual.dot(generous.inverse() * innovation.residual);
      if (nis < params_.tracking.gate) {
        candidates.push_back({i, index, nis});
      }
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Match& a, const Match& b) { return a.nis < b.nis; });
  std::vector<Match> matches;
  for (const Match& candidate : candidates) {
    if (std::none_of(matches.begin(), matches.end(), [&](const Match& m) {
          return m.sighting == candidate.sighting || m.fixture == candidate.fixture;
        })) {
      matches.push_back(candidate);
    }
  }
  return matches;
}

void ModernLocalizer::track(const SightingFrame& frame, const std::vector<int>& objects,
                            const OdometryReading& odometry) {
  const std::vector<Match> matches = match(frame, odometry);
  watch(frame, objects, matches);
  correct_filter(frame, matches, odometry);
}

void ModernLocalizer::correct_filter(const SightingFrame& frame, const std::vector<Match>& matches,
                                     const OdometryReading& odometry) {
  for (const Match& match : matches) {
    const Innovation innovation = filter_.innovate(frame.sightings[match.sighting], match.fixture, map_[match.fixture],
                                                   odometry.linear, odometry.angular);
    if (innovation.nis > params_.tracking.gate) {
      filter_.widen(kSurprise);
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

void ModernLocalizer::watch(const SightingFrame& frame, const std::vector<int>& objects,
                            const std::vector<Match>& matches) {
  const PoseBelief belief = filter_.belief();
  // what is seen and fits nothing
  std::string unexplained;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const bool is_matched =
        std::any_of(matches.begin(), matches.end(), [&](const Match& m) { return m.sighting == i; });
    const Eigen::Vector2d place = belief.pose * frame.sightings[i].robot_from_fixture.position();
    if (!is_matched && scene_.objects()[static_cast<std::size_t>(objects[i])].frames >= 2) {
      unexplained =
          fmt::format("a fixture is seen at ({:.1f}, {:.1f}) where the building has none", place.x(), place.y());
    }
  }
  note_pause();
  if (!matches.empty()) {
    misfit_run_ = 0;
    missed_frames_.clear();
    still_frames_ = 0;
    paused_ = false;
    odom_at_match_ = filter_odometry_->odom_from_robot;
    seen_lately_.clear();
    for (const Match& m : matches) {
      seen_lately_.push_back(m.fixture);
    }
    return;
  }
  misfit_run_ += unexplained.empty() ? 0 : 1;
  const std::optional<int> missed = count_missing(frame);
  if (!doubt_.empty()) {
    return;
  }
  if (misfit_run_ >= params_.rules.misfit_frames) {
    doubt(unexplained.empty() ? "what is seen fits no fixture" : unexplained, params_.rules.bonus_after_misfit);
  } else if (missed) {
    doubt_fixture_ = *missed;
    doubt(fmt::format("fixture {} ought to be in view and is not seen", map_[*missed].id),
          params_.rules.bonus_after_miss);
  }
}

void ModernLocalizer::note_pause() {
  const Pose2 step = odom_at_frame_.inverse() * filter_odometry_->odom_from_robot;
  odom_at_frame_ = filter_odometry_->odom_from_robot;
  const bool still = std::hypot(step.x, step.y) < 0.001 && std::abs(step.theta) < radians(0.1);
  still_frames_ = still ? still_frames_ + 1 : 0;
  paused_ = paused_ || still_frames_ >= params_.rules.pause_frames;
}

std::optional<int> ModernLocalizer::count_missing(const SightingFrame& frame) {
  const TrackingRules& rules = params_.rules;
  const PoseBelief belief = filter_.belief();
  const Pose2 since_match = odom_at_match_.inverse() * filter_odometry_->odom_from_robot;
  const bool stands_still =
      std::hypot(since_match.x, since_match.y) < rules.still_distance && std::abs(since_match.theta) < rules.still_turn;
  const double margin = rules.visible_margin + 2.0 * position_sigma(belief.covariance);
  std::vector<int> near;
  map_.find_near(belief.pose.position(), view_.radius(building_.ceiling_height) + 1.0, near);
  for (const int index : near) {
    const Pose2 robot_from_fixture = belief.pose.inverse() * map_[index].world_from_fixture;
    const bool is_there = std::any_of(frame.sightings.begin(), frame.sightings.end(), [&](const FixtureSighting& s) {
      return distance(s.robot_from_fixture, robot_from_fixture) < 0.5 * map_[index].length + 0.2;
    });
    const bool vanished =
        stands_still && std::find(seen_lately_.begin(), seen_lately_.end(), index) != seen_lately_.end();
    const double least = vanished ? rules.vanish_share : rules.miss_share;
    if (is_there || unreliable_.count(index) > 0 ||
        view_.visible_share(robot_from_fixture, map_[index], margin) < least) {
      continue;
    }
    const int frames = ++missed_frames_[index];
    if (vanished && frames >= rules.vanish_frames) {
      return index;
    }
  }
  // The detector misses a fixture from some places while the robot passes; that it misses several, or one over a long
  // way, is unlikely. Who stood still since the last match may have been carried: then one is enough.
  int worst = -1;
  int several = 0;
  for (const auto& [index, frames] : missed_frames_) {
    several += frames >= rules.miss_frames ? 1 : 0;
    if (worst < 0 || frames > missed_frames_.at(worst)) {
      worst = index;
    }
  }
  const bool over_a_way = worst >= 0 && missed_frames_.at(worst) >= rules.miss_frames &&
                          odometer_ - odometer_at_fixture_ > rules.miss_distance;
  return several >= (paused_ ? 1 : rules.miss_fixtures) || over_a_way ? std::optional(worst) : std::nullopt;
}

void ModernLocalizer::doubt(const std::string& why, double bonus) {
  doubt_ = why;
  misfit_run_ = 0;
  missed_frames_.clear();
  seen_lately_.clear();
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

void ModernLocalizer::decide(const SightingFrame& frame) {
  const TrackingRules& rules = params_.rules;
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  if (all.empty()) {
    leader_id_ = 0;
    doubt_.clear();
    state_ = LocalizerState::kLost;
    reason_ = map_.size() == 0           ? "the building's file names no fixtures"
              : scene_.objects().empty() ? "no fixture seen yet"
                                         : "what is seen fits nowhere in the building";
    return;
  }
  const Hypothesis& best = all.front();
  const double second = all.size() > 1 ? all[1].total : -1e18;
  const double margin = best.total - std::max(second, bank_.null_score());

  if (leader_id_ != 0) {
    const Hypothesis* held = leader();
    if (held == nullptr || best.total - held->total > 6.0) {
      leader_id_ = 0;
      doubt_.clear();
      state_ = LocalizerState::kAmbiguous;
    }
  }
  if (!frame.sightings.empty() && state_ != LocalizerState::kTracking) {
    unexplained_run_ = best.last_match == frame.utime ? 0 : unexplained_run_ + 1;
    if (unexplained_run_ >= rules.restart_frames) {
      unexplained_run_ = 0;
      const PoseBelief old = leader_id_ != 0 ? filter_.belief() : best.belief;
      scene_.clear();
      bank_.clear();
      bank_.add_guess(old, 0.0);
      leader_id_ = 0;
      doubt_.clear();
      state_ = LocalizerState::kLost;
      reason_ = "nothing explained what was seen; searching anew";
      return;
    }
  }
  const PoseBelief belief = leader_id_ != 0 ? filter_.belief() : best.belief;
  const double sigma = largest_position_sigma(belief.covariance);
  const double heading_sigma = std::sqrt(belief.covariance(2, 2));
  if (state_ == LocalizerState::kTracking) {
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
    return;
  }
  if (wide_ && leader_id_ != 0 && margin >= rules.leave_margin && sigma < rules.enter_position_sigma &&
      doubt_.empty() && best.id == leader_id_ && best.last_match == frame.utime) {
    wide_ = false;
    state_ = LocalizerState::kTracking;
    return;
  }
  const bool is_confirmed =
      static_cast<int>(best.confirmed.size()) >= (best.id == leader_id_ ? 1 : rules.enter_fixtures);
  if (margin >= rules.enter_margin && is_confirmed && !frame.sightings.empty() && best.last_match == frame.utime &&
      largest_position_sigma(best.belief.covariance) < rules.enter_position_sigma) {
    if (best.id != leader_id_) {
      PoseBelief start = best.belief;
      start.covariance += Eigen::Vector3d(0.01, 0.01, 0.003).asDiagonal();
      filter_.start(start);
      leader_id_ = best.id;
      correct_filter(frame, match(frame, *filter_odometry_), *filter_odometry_);
    }
    if (best.id == doubted_id_ && doubt_fixture_ >= 0) {
      unreliable_.insert(doubt_fixture_);  // the pose was right: the fixture is dead, gone or hard to see
    }
    doubt_fixture_ = -1;
    wide_ = false;
    doubt_.clear();
    misfit_run_ = 0;
    missed_frames_.clear();
    state_ = LocalizerState::kTracking;
    reason_ = fmt::format("one pose explains {} fixtures, all others fail", best.confirmed.size());
    return;
  }
  state_ = LocalizerState::kAmbiguous;
  if (!doubt_.empty()) {
    reason_ = doubt_;
  } else if (!wide_) {
    const auto close = std::count_if(all.begin(), all.end(),
                                     [&](const Hypothesis& h) { return h.total > best.total - rules.enter_margin; });
    reason_ = close > 1 ? fmt::format("{} poses explain what was seen", close)
                        : fmt::format("one pose is left, confirmed by {} fixtures so far", best.confirmed.size());
  }
}

LocalizerEstimate ModernLocalizer::estimate() const {
  LocalizerEstimate estimate;
  estimate.state = state_;
  estimate.reason = reason_;
  estimate.fixture_utime = fixture_utime_;
  estimate.has_nis = has_nis_;
  estimate.nis = nis_;
  estimate.initial_pose_id = guess_id_;
  Pose2 ahead;
  if (filter_odometry_ && !queue_.history().is_empty()) {
    ahead = filter_odometry_->odom_from_robot.inverse() * queue_.history().newest().odom_from_robot;
  }
  estimate.distance_since_fixture = odometer_ - odometer_at_fixture_ + std::hypot(ahead.x, ahead.y);
  if (leader_id_ != 0) {
    estimate.estimator = EstimatorKind::kKalmanFilter;
    estimate.belief = filter_.belief_after(ahead);
  } else if (!bank_.hypotheses().empty()) {
    estimate.estimator = EstimatorKind::kHypotheses;
    estimate.belief = bank_.hypotheses().front().belief;
    predict(estimate.belief, ahead, odometry_noise(ahead, robot_.wheel_base, ErrorParams{}));
  }
  if (state_ == LocalizerState::kAmbiguous) {
    // as wide as the poses still possible
    const std::vector<WeightedPose> possible = hypotheses(200);
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    double turned = 0.0;
    for (const WeightedPose& pose : possible) {
      const Eigen::Vector2d offset = pose.pose.position() - estimate.belief.pose.position();
      spread += pose.weight * offset * offset.transpose();
      turned += pose.weight * std::pow(wrap_angle(pose.pose.theta - estimate.belief.pose.theta), 2);
    }
    estimate.belief.covariance.topLeftCorner<2, 2>() += spread;
    estimate.belief.covariance(2, 2) += turned;
  } else if (state_ == LocalizerState::kLost) {
    estimate.estimator = bank_.hypotheses().empty() ? EstimatorKind::kNone : EstimatorKind::kHypotheses;
    estimate.belief.covariance = unknown_pose_covariance();
  }
  return estimate;
}

std::vector<WeightedPose> ModernLocalizer::hypotheses(std::size_t most) const {
  std::vector<WeightedPose> result;
  if (bank_.hypotheses().empty()) {
    return result;
  }
  Pose2 ahead;
  if (filter_odometry_ && !queue_.history().is_empty()) {
    ahead = filter_odometry_->odom_from_robot.inverse() * queue_.history().newest().odom_from_robot;
  }
  const double best = bank_.hypotheses().front().total;
  double sum = 0.0;
  for (const Hypothesis& hypothesis : bank_.hypotheses()) {
    sum += std::exp(hypothesis.total - best);
  }
  for (const Hypothesis& hypothesis : bank_.hypotheses()) {
    if (result.size() >= most) {
      break;
    }
    result.push_back({hypothesis.belief.pose * ahead, std::exp(hypothesis.total - best) / sum,
                      position_sigma(hypothesis.belief.covariance)});
  }
  return result;
}

}  // namespace luminav
