#include "tests/evaluation/judge/run_judge.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/tiles/tile_codec.hpp"
#include "tests/evaluation/judge/map_score.hpp"

namespace luminav {
namespace {

constexpr double kWrongPosition = 0.5;           // [m] the contract's bound of "confidently wrong"
constexpr double kWrongHeading = radians(20.0);  // [rad]
constexpr double kGrace = 1.0;                   // [s] after the first contradicting image of a mishap
constexpr double kBumpTime = 0.2;                // [s] that a bump takes
constexpr std::int64_t kHistory = 3'000'000;     // [us]
constexpr int kTrailEvery = 5;                   // poses

// What a fixture seen says of a tracked pose at 99.9 %: beyond the localizer's kFixtureSurprise it contradicts.
constexpr ViewGate kTrackingGate{0.25, radians(6.0)};

// A free stretch: following a path for two seconds, more than a metre to go, nothing within 0.4 m, nobody within 2.5 m.
constexpr double kFreeClearance = 0.4;     // [m]
constexpr double kFreeOfPeople = 2.5;      // [m]
constexpr double kFreeAfter = 2.0;         // [s]
constexpr double kFreeDistanceLeft = 1.0;  // [m]

double seconds(std::int64_t microseconds) {
  return static_cast<double>(microseconds) * 1e-6;
}

Pose2 pose_of(const sim_truth_t& truth) {
  return {truth.x, truth.y, truth.theta};
}

/// An event moves the robot otherwise than its wheels tell.
bool is_moved_by(const std::vector<ScenarioEvent>& events, double now) {
  return std::any_of(events.begin(), events.end(), [&](const ScenarioEvent& event) {
    const double duration = event.kind == EventKind::kSlip   ? event.duration
                            : event.kind == EventKind::kBump ? kBumpTime
                                                             : 0.0;
    return now >= event.at && now < event.at + duration;
  });
}

/// Of at least one value.
double quantile(std::vector<double> values, double q) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

RunJudge::RunJudge(lcm::LCM& lcm, const Scenario& scenario, const WorldTruth& world)
    : scenario_(scenario),
      world_(world),
      visibility_(world.building.fixtures, CeilingCamera(world.robot.camera.intrinsics, world.robot.camera.mounting)),
      subscriber_(lcm) {
  subscriber_.on(channels::kSimTruth, &RunJudge::on_truth, this);
  subscriber_.on(channels::kPose, &RunJudge::on_pose, this);
  subscriber_.on(channels::kOdometry, &RunJudge::on_odometry, this);
  subscriber_.on(channels::kNavigationStatus, &RunJudge::on_navigation, this);
  subscriber_.on(channels::kGridTile, &RunJudge::on_tile, this);
  subscriber_.on(channels::kNodeStatus, &RunJudge::on_node_status, this);
}

double RunJudge::elapsed() const {
  return truth_ ? seconds(truth_->utime - first_utime_) : 0.0;
}

std::optional<Pose2> RunJudge::truth_at(std::int64_t utime) const {
  const auto after = std::lower_bound(recent_truth_.begin(), recent_truth_.end(), utime,
                                      [](const sim_truth_t& truth, std::int64_t t) { return truth.utime < t; });
  if (after == recent_truth_.end()) {
    return recent_truth_.empty() || utime - recent_truth_.back().utime > 50'000
               ? std::nullopt
               : std::optional(pose_of(recent_truth_.back()));
  }
  if (after == recent_truth_.begin()) {
    return after->utime == utime ? std::optional(pose_of(*after)) : std::nullopt;
  }
  const sim_truth_t& before = *std::prev(after);
  return interpolate(pose_of(before), pose_of(*after),
                     seconds(utime - before.utime) / seconds(after->utime - before.utime));
}

void RunJudge::on_truth(const sim_truth_t& truth) {
  if (first_utime_ == 0) {
    first_utime_ = truth.utime;
  }
  if (truth_) {
    const double step = distance(pose_of(*truth_), pose_of(truth));
    const double duration = seconds(truth.utime - truth_->utime);
    if (!truth.carried) {
      driven_ += step;
    }
    const bool following = navigation_ && navigation_->state == navigation_status_t::STATE_FOLLOWING;
    following_since_ = !following ? -1.0 : (following_since_ < 0.0 ? elapsed() : following_since_);
    bool free = following && elapsed() - following_since_ > kFreeAfter &&
                navigation_->distance_left > kFreeDistanceLeft && truth.clearance > kFreeClearance && !truth.carried;
    for (std::size_t i = 0; i < truth.person_x.size() && free; ++i) {
      free = std::hypot(truth.person_x[i] - truth.x, truth.person_y[i] - truth.y) > kFreeOfPeople;
    }
    if (free) {
      free_distance_ += step;
      free_time_ += duration;
    }
    if (truth.carried && !truth_->carried) {
      carry_open_ = true;
      carry_noticed_ = false;
      contradicted_at_.reset();
    }
  }
  min_clearance_ = std::min(min_clearance_, truth.clearance);
  truth_ = truth;
  is_moved_ = truth.carried || is_moved_by(scenario_.events, elapsed());
  if (is_moved_ && !mishap_open_ && pose_ && pose_->state == pose_t::STATE_TRACKING && !is_wrong()) {
    mishap_open_ = true;
    told_at_.reset();
  }
  recent_truth_.push_back(truth);
  while (truth.utime - recent_truth_.front().utime > kHistory) {
    recent_truth_.pop_front();
  }
}

void RunJudge::on_pose(const pose_t& pose) {
  const double duration = pose_ ? seconds(std::clamp<std::int64_t>(pose.utime - pose_->utime, 0, 1'000'000)) : 0.0;
  pose_ = pose;
  const std::optional<Pose2> truth = truth_at(pose.utime);
  if (!truth) {
    return;
  }
  position_error_ = std::hypot(pose.x - truth->x, pose.y - truth->y);
  heading_error_ = std::abs(wrap_angle(pose.theta - truth->theta));
  posed_s_ += duration;
  ambiguous_s_ += pose.state == pose_t::STATE_AMBIGUOUS ? duration : 0.0;
  judge_tracking(pose, *truth, duration);
  if (pose.sequence % kTrailEvery == 0) {
    const Pose2 odometry = odometry_ ? odom_from_robot(*odometry_) : Pose2{};
    trail_.push_back({*truth, world_from_robot(pose), odometry, pose.state, pose.estimator, elapsed()});
  }
}

void RunJudge::judge_tracking(const pose_t& pose, const Pose2& truth, double duration) {
  const bool is_tracking = pose.state == pose_t::STATE_TRACKING;
  if (is_tracking && !localized_) {
    localized_ = true;
    localized_s_ = elapsed();
    localized_after_m_ = driven_;
  }
  judge_carries(pose, truth);
  judge_mishap(pose, truth);
  const bool in_grace = mishap_open_ && (!told_at_ || seconds(pose.utime - *told_at_) < kGrace);
  if (is_tracking && is_wrong() && !in_grace) {
    confident_wrong_s_ += duration;
  }
  if (localized_ && !carry_open_) {
    watched_s_ += duration;
    tracking_s_ += is_tracking ? duration : 0.0;
  }
  if (!is_tracking || carry_open_) {
    return;
  }
  position_errors_.push_back(position_error_);
  heading_errors_.push_back(heading_error_);
  if (!visibility_.visible_from(truth, 0.3).empty()) {
    in_view_square_position_ += position_error_ * position_error_;
    in_view_square_heading_ += heading_error_ * heading_error_;
    ++in_view_count_;
  }
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 9; ++i) {
    covariance(i / 3, i % 3) = pose.covariance[i];
  }
  const Eigen::Vector3d error(pose.x - truth.x, pose.y - truth.y, wrap_angle(pose.theta - truth.theta));
  const double nees = error.dot(covariance.inverse() * error) / 3.0;
  if (std::isfinite(nees)) {
    nees_sum_ += nees;
    ++nees_count_;
  }
}

bool RunJudge::is_wrong() const {
  return position_error_ > kWrongPosition || heading_error_ > kWrongHeading;
}

void RunJudge::judge_mishap(const pose_t& pose, const Pose2& truth) {
  // noticed once it leaves TRACKING: it answers for what it declares next
  mishap_open_ = mishap_open_ && pose.state == pose_t::STATE_TRACKING;
  if (!mishap_open_) {
    return;
  }
  if (visibility_.contradicts(truth, world_from_robot(pose), kTrackingGate)) {
    told_at_ = told_at_.value_or(pose.utime);
  } else if (!is_wrong() && !visibility_.visible_from(truth, 0.3).empty()) {
    told_at_.reset();
    mishap_open_ = is_moved_;
  }
}

void RunJudge::judge_carries(const pose_t& pose, const Pose2& truth) {
  if (!carry_open_) {
    return;
  }
  const bool is_tracking = pose.state == pose_t::STATE_TRACKING;
  if (!contradicted_at_ && visibility_.contradicts(truth, world_from_robot(pose))) {
    contradicted_at_ = pose.utime;
  }
  const bool in_time = !contradicted_at_ || seconds(pose.utime - *contradicted_at_) <= kGrace + 0.1;
  if (!is_tracking && !carry_noticed_ && in_time) {
    carry_noticed_ = true;
    ++carries_noticed_;
  }
  if (is_tracking && !is_wrong() && truth_ && !truth_->carried) {
    if (!carry_noticed_ && !contradicted_at_) {
      ++carries_noticed_;  // followed it with its eyes: no image ever contradicted the belief
    }
    ++carries_recovered_;
    carry_open_ = false;
  }
}

void RunJudge::on_tile(const grid_tile_t& tile) {
  if (!is_possible(tile)) {
    return;
  }
  if (!tiles_.empty() && !(geometry_of(tiles_.begin()->second) == geometry_of(tile))) {
    tiles_.clear();
  }
  tiles_[{tile.tile_column, tile.tile_row}] = tile;
}

std::optional<OccupancyGrid> RunJudge::grid() const {
  if (tiles_.empty()) {
    return std::nullopt;
  }
  std::optional<OccupancyGrid> grid(std::in_place, geometry_of(tiles_.begin()->second));
  for (const auto& [place, tile] : tiles_) {
    [[maybe_unused]] const bool applied = apply_tile(tile, *grid);
  }
  return grid;
}

void RunJudge::on_node_status(const node_status_t& status) {
  ProcessFigures& figures = processes_[status.process];
  if (figures.memory > 0) {  // the first message has no interval to measure over
    figures.cpu_sum += status.cpu_fraction;
    ++figures.count;
  }
  figures.memory = std::max(figures.memory, status.memory_bytes);
}

RunReport RunJudge::report(std::vector<GoalResult> goals) const {
  RunReport r;
  r.scenario = scenario_.name;
  r.seed = scenario_.seed;
  r.simulated_s = elapsed();
  r.world_table = world_.table;
  r.world_hash = world_.hash;
  r.localized = localized_;
  r.localized_s = localized_s_;
  r.localized_after_m = localized_after_m_;
  r.tracking_ratio = watched_s_ > 0.0 ? tracking_s_ / watched_s_ : 0.0;
  r.ambiguous_ratio = posed_s_ > 0.0 ? ambiguous_s_ / posed_s_ : 0.0;
  r.confident_wrong_s = confident_wrong_s_;
  if (in_view_count_ > 0) {
    r.in_view_position_rms_m = std::sqrt(in_view_square_position_ / in_view_count_);
    r.in_view_heading_rms_deg = degrees(std::sqrt(in_view_square_heading_ / in_view_count_));
  }
  if (!position_errors_.empty()) {
    r.mission_position_p95_m = quantile(position_errors_, 0.95);
    r.mission_heading_p95_deg = degrees(quantile(heading_errors_, 0.95));
  }
  if (nees_count_ > 0) {
    r.nees = nees_sum_ / nees_count_;
  }
  r.mean_speed_m_s = free_time_ > 0.0 ? free_distance_ / free_time_ : 0.0;
  r.driven_m = driven_;
  r.goals = std::move(goals);
  r.min_clearance_m = min_clearance_;
  if (truth_) {
    r.contacts = truth_->contacts;
    r.hard_contacts = truth_->hard_contacts;
    // one that goes on as the run ends tells nothing yet
    const bool in_hands = truth_->carried != 0;
    r.carries = truth_->carries - (in_hands ? 1 : 0);
    r.carries_noticed = carries_noticed_ - (in_hands && carry_noticed_ ? 1 : 0);
  }
  r.carries_recovered = carries_recovered_;
  if (const auto grid = this->grid(); grid && !world_.walls.cells.empty()) {
    r.map = score_map(*grid, world_, trail_);
  }
  for (const auto& [name, figures] : processes_) {
    r.processes.push_back({name, figures.count > 0 ? 100.0 * figures.cpu_sum / figures.count : 0.0,
                           static_cast<double>(figures.memory) / 1e6, 0});
  }
  return r;
}

}  // namespace luminav
