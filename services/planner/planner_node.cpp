#include "services/planner/planner_node.hpp"

#include <fmt/format.h>
#include <luminav/navigation_status_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/tile_request_t.hpp>

#include <algorithm>
#include <cmath>

#include "services/common/configuration/building_edit.hpp"
#include "services/common/geometry/seconds.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"

namespace luminav {
namespace {

constexpr double kPoseAge = 1.0;     // [s] an older pose does not count
constexpr double kControlAge = 2.0;  // [s] a controller silent for longer does not count
constexpr std::int64_t kActivePeriod =
    95'000;  // [us] NAVIGATION_STATUS at 10 Hz with a goal; below the 100 ms of ODOMETRY
constexpr std::int64_t kIdlePeriod = 950'000;       // [us] and at 1 Hz without
constexpr std::int64_t kPathPeriod = 950'000;       // [us] PATH is repeated: a datagram may get lost
constexpr std::int64_t kRequestPeriod = 2'000'000;  // [us] between TILE_REQUESTs
constexpr std::int64_t kKeepPeriod = 20'000'000;    // [us] a goal is kept anew: how long ago tells whether it goes on
constexpr std::size_t kRememberedIds = 32;
constexpr std::size_t kMaxRequested = 200;
constexpr int kMaxStops = 1000;

GoalRequest request_from(const goal_t& message) {
  GoalRequest request;
  request.id = message.id;
  for (const goal_pose_t& pose : message.poses) {
    request.stops.push_back({pose.place, {pose.x, pose.y, wrap_angle(pose.theta)}, pose.has_theta != 0, pose.wait});
  }
  request.loop = message.loop != 0;
  request.policy = static_cast<FailurePolicy>(message.policy);
  request.tolerance = message.tolerance;
  request.heading_tolerance = message.heading_tolerance;
  return request;
}

}  // namespace

PlannerNode::PlannerNode(lcm::LCM& lcm, const PlannerConfig& config, std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      zones_(config.route.space.zones, config.local_clock),
      executor_(config.goals, config.route, config.doors),
      store_(config.state_folder),
      accepted_{},
      subscriber_(lcm, key) {
  subscriber_.on(channels::kGoal, &PlannerNode::on_goal, this);
  subscriber_.on(channels::kGridTile, &PlannerNode::on_grid_tile, this);
  subscriber_.on(channels::kPose, &PlannerNode::on_pose, this);
  subscriber_.on(channels::kControlStatus, &PlannerNode::on_control_status, this);
  subscriber_.on(channels::kRobotStatus, &PlannerNode::on_robot_status, this);
}

Health PlannerNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  health.degraded = !store_error_.empty();
  health.reason = store_error_;
  return health;
}

void PlannerNode::set_building(const Building& building) {
  config_.places = building.places;
  if (!are_same_zones(zones_.all(), building.zones)) {
    zones_.set(building.zones);
    executor_.set_zones(zones_.in_force());
    publish_path(now_);
  }
}

// ---------------------------------------------------------------------------------------------------- requests

bool PlannerNode::is_of_this_building(const goal_pose_t& pose) const {
  constexpr double kSamePlace = 0.01;  // [m]
  return pose.place.empty() || config_.building.empty() ||
         std::any_of(config_.places.begin(), config_.places.end(), [&](const Place& place) {
           return place.name == pose.place && std::hypot(place.pose.x - pose.x, place.pose.y - pose.y) < kSamePlace;
         });
}

std::string PlannerNode::objection_to(const goal_t& goal) const {
  if (!goal.floor.empty()) {
    return fmt::format("the goal is on floor {}, but this building has one floor only", goal.floor);
  }
  if (goal.count < 1 || goal.count > kMaxStops || static_cast<std::size_t>(goal.count) != goal.poses.size()) {
    return fmt::format("a goal of {} poses, must be 1 to {}", goal.count, kMaxStops);
  }
  if (!all_finite({goal.tolerance, goal.heading_tolerance}) || goal.tolerance < 0.0 || goal.heading_tolerance < 0.0) {
    return "the goal's tolerance is not a number of 0 or more";
  }
  if (goal.policy < goal_t::POLICY_SKIP || goal.policy > goal_t::POLICY_STOP) {
    return fmt::format("unknown policy {}", static_cast<int>(goal.policy));
  }
  for (const goal_pose_t& pose : goal.poses) {
    if (!all_finite({pose.x, pose.y, pose.theta, pose.wait}) || std::abs(pose.x) > 1e5 || std::abs(pose.y) > 1e5 ||
        pose.wait < 0.0) {
      return "a pose of the goal is not a number, or lies impossibly far away";
    }
    if (const Zone* zone = find_zone(zones_.in_force(), ZoneKind::kKeepOut, {pose.x, pose.y})) {
      return fmt::format("{} lies in {}, which is a keep-out zone{}",
                         pose.place.empty() ? fmt::format("({:.1f}, {:.1f})", pose.x, pose.y) : pose.place, zone->name,
                         until_of(*zone));
    }
    if (!is_of_this_building(pose)) {
      return fmt::format("{} has no place {} at ({:.1f}, {:.1f}): who asked has another building", config_.building,
                         pose.place, pose.x, pose.y);
    }
  }
  return "";
}

void PlannerNode::on_goal(const goal_t& goal) {
  if (goal.id == 0) {
    subscriber_.drop("GOAL without an id");
    return;
  }
  if (std::find(done_ids_.begin(), done_ids_.end(), goal.id) != done_ids_.end()) {
    return;  // repeated until the echo arrives
  }
  if (!done_ids_.empty() && goal.id < *std::max_element(done_ids_.begin(), done_ids_.end())) {
    subscriber_.drop("GOAL from before the last one");
    return;
  }
  if (now_ == 0) {
    waiting_goal_ = goal;  // nothing from the robot yet: no stamp to answer with
    return;
  }
  act_on(goal, now_);
  executor_.update(situation(now_));  // a robot that knows where it is does not search first
  publish_path(now_);
  publish_status(now_);
}

void PlannerNode::act_on(const goal_t& goal, std::int64_t now) {
  done_ids_.push_back(goal.id);
  if (done_ids_.size() > kRememberedIds) {
    done_ids_.pop_front();
  }
  switch (goal.action) {
    case goal_t::ACTION_GO: {
      const std::string objection = objection_to(goal);
      if (!objection.empty()) {
        subscriber_.drop("GOAL: " + objection);
        executor_.refuse(goal.id, objection, now);
        break;
      }
      accepted_ = goal;
      executor_.start(request_from(goal), now);
      break;
    }
    case goal_t::ACTION_CANCEL:
      executor_.cancel(goal.id, now);
      break;
    case goal_t::ACTION_PAUSE:
      executor_.pause(goal.id, now);
      break;
    case goal_t::ACTION_RESUME:
      executor_.resume(goal.id, now);
      break;
    default:
      subscriber_.drop(fmt::format("GOAL with unknown action {}", static_cast<int>(goal.action)));
  }
  keep_goal();
}

void PlannerNode::keep(bool asks) {
  StoredGoal stored{accepted_, executor_.stop_index(), asks, {config_.boot, config_.building, now_}};
  store_.keep(stored);
  kept_ = std::move(stored);
}

void PlannerNode::keep_goal() {
  try {
    if (!executor_.is_active()) {
      if (kept_) {
        store_.forget();
        kept_.reset();
      }
    } else if (!kept_ || kept_->goal.id != accepted_.id || kept_->pose_index != executor_.stop_index() ||
               kept_->asks != executor_.is_paused() || now_ - kept_->kept.utime > kKeepPeriod ||
               now_ < kept_->kept.utime) {
      keep(executor_.is_paused());
    }
    store_error_.clear();
  } catch (const std::exception& error) {
    store_error_ = error.what();
  }
}

void PlannerNode::end() {
  try {
    if (executor_.is_active()) {
      keep(true);
    }
  } catch (const std::exception& error) {
    store_error_ = error.what();
  }
}

void PlannerNode::resume_stored_goal(std::int64_t now) {
  stored_goal_checked_ = true;
  const std::optional<StoredGoal> stored = store_.recall();
  if (!stored || executor_.is_active() || !objection_to(stored->goal).empty()) {
    return;
  }
  accepted_ = stored->goal;
  done_ids_.push_back(accepted_.id);
  const std::string objection = objection_to_resuming(*stored, {config_.boot, config_.building, now});
  if (objection.empty()) {
    executor_.resume_at(request_from(accepted_), stored->pose_index, now);
  } else if (stored->kept.building != config_.building) {
    kept_ = stored;  // its coordinates mean nothing here
    executor_.refuse(accepted_.id, "a kept goal is dropped: " + objection, now);
  } else {
    executor_.show_paused(request_from(accepted_), stored->pose_index, objection, now);
  }
}

// ---------------------------------------------------------------------------------------------------- inputs

void PlannerNode::on_grid_tile(const grid_tile_t& tile) {
  switch (map_.add(tile)) {
    case TileMap::Result::kRefused:
      subscriber_.drop("GRID_TILE that does not fit");
      break;
    case TileMap::Result::kChanged:
      executor_.map_changed(map_.grid(), map_.received(), map_.tiles());
      break;
    case TileMap::Result::kUnchanged:
      break;
  }
}

void PlannerNode::on_pose(const pose_t& pose) {
  if (!is_possible(pose) || pose.utime <= 0) {
    subscriber_.drop("POSE: impossible");
    return;
  }
  if (pose_ && pose.utime == pose_->utime) {
    pose_ = pose;  // corrected by a picture, no new tick
    return;
  }
  const StampGuard::Verdict verdict = pose_stamps_.check(pose.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("POSE older than the last");
    return;
  }
  if (verdict == StampGuard::Verdict::kNewSession) {
    now_ = 0;
  }
  pose_ = pose;
  tick(pose.utime);
}

void PlannerNode::on_robot_status(const robot_status_t& status) {
  const StampGuard::Verdict verdict = robot_stamps_.check(status.utime);
  if (status.utime <= 0 || verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("ROBOT_STATUS older than the last");
    return;
  }
  if (verdict == StampGuard::Verdict::kNewSession) {
    now_ = 0;
  }
  // kept until the next tick: a touch may be over by then, and the controller about to leave
  const bool begins = is_blocked(status) && !(robot_ && is_blocked(*robot_));
  const bool follows = control_ && control_->state == control_status_t::STATE_FOLLOWING;
  has_touched_ = has_touched_ || (begins && follows);
  robot_ = status;
  // POSE is the better tick: it is what the plan is made from
  if (!pose_ || status.utime - pose_->utime > 150'000 || status.utime < pose_->utime - 1'000'000) {
    tick(status.utime);
  }
}

void PlannerNode::on_control_status(const control_status_t& status) {
  if (!all_finite({status.seconds_without_progress}) ||
      control_stamps_.check(status.utime) == StampGuard::Verdict::kOld) {
    // the controller answers ODOMETRY and ROBOT_STATUS, two of its words may carry one stamp
    if (control_ && status.utime == control_->utime && status.sequence > control_->sequence) {
      control_ = status;
    }
    return;
  }
  control_ = status;
  control_heard_ = now_;
}

// ---------------------------------------------------------------------------------------------------- the tick

Situation PlannerNode::situation(std::int64_t now) const {
  Situation moment;
  moment.now = now;
  moment.has_touched = has_touched_;
  if (!pose_ || seconds_between(pose_->utime, now) > kPoseAge || pose_->utime - now > 1'000'000) {
    moment.localization = "no pose from the localizer for more than a second";
  } else {
    moment.tracking = pose_->state == pose_t::STATE_TRACKING;
    moment.world_from_robot = world_from_robot(*pose_);
    moment.localization = pose_->reason;
  }
  if (robot_) {
    const char* why = !robot_->connected        ? "the robot does not answer"
                      : robot_->stop_engaged    ? "a stop is engaged"
                      : robot_->stop_button     ? "the button on the robot is pressed"
                      : !robot_->motors_enabled ? "the motors are off"
                                                : nullptr;
    moment.can_move = why == nullptr;
    moment.cannot_move = why == nullptr ? "" : why;
  }
  if (control_ && seconds_between(control_heard_, now) <= kControlAge) {
    ControlReport report;
    report.at_goal = control_->state == control_status_t::STATE_AT_GOAL;
    report.yielding = control_->state == control_status_t::STATE_YIELDING;
    report.stuck = control_->state == control_status_t::STATE_STUCK;
    report.follows = control_->state == control_status_t::STATE_FOLLOWING;
    report.path_sequence = control_->path_sequence;
    report.seconds_without_progress = control_->seconds_without_progress;
    report.reason = control_->reason;
    if (control_->stop_engaged && moment.can_move) {
      moment.can_move = false;
      moment.cannot_move = "a stop is engaged";
    }
    moment.control = report;
  }
  return moment;
}

void PlannerNode::tick(std::int64_t utime) {
  if (utime < now_) {
    return;  // the other of the two streams is ahead
  }
  now_ = utime;
  if (zones_.tell(utime)) {
    executor_.set_zones(zones_.in_force());
  }
  if (!stored_goal_checked_) {
    resume_stored_goal(utime);
  }
  if (waiting_goal_) {
    act_on(*waiting_goal_, utime);
    waiting_goal_.reset();
  }
  if (control_heard_ > utime || control_heard_ == 0) {
    control_heard_ = utime;
  }
  request_tiles(utime);
  executor_.update(situation(utime));
  has_touched_ = false;
  keep_goal();
  publish_path(utime);
  publish_status(utime);
}

void PlannerNode::request_tiles(std::int64_t now) {
  if (map_.is_complete() || (last_request_ != 0 && now >= last_request_ && now - last_request_ < kRequestPeriod)) {
    return;
  }
  last_request_ = now;
  tile_request_t request{};
  request.utime = now;
  request.id = ++request_id_;
  map_.missing(kMaxRequested, request.tile_column, request.tile_row);
  request.count = static_cast<std::int32_t>(request.tile_column.size());  // none known yet: all of them
  lcm_.publish(channels::kTileRequest, &request);
}

void PlannerNode::publish_path(std::int64_t now) {
  const GoalPath& path = executor_.path();
  const bool is_new = path.sequence != published_sequence_;
  const bool is_due = executor_.is_active() && (now < last_path_ || now - last_path_ >= kPathPeriod);
  if (path.sequence == 0 || (!is_new && !is_due)) {
    return;
  }
  published_sequence_ = path.sequence;
  last_path_ = now;
  path_t message{};
  message.utime = now;
  message.goal_id = path.goal_id;
  message.pose_index = path.stop_index;
  message.sequence = path.sequence;
  message.tolerance = path.tolerance;
  message.has_theta = path.has_theta;
  message.theta = path.theta;
  message.heading_tolerance = path.heading_tolerance;
  message.count = static_cast<std::int32_t>(path.points.size());
  for (const Eigen::Vector2d& point : path.points) {
    message.x.push_back(static_cast<float>(point.x()));
    message.y.push_back(static_cast<float>(point.y()));
  }
  lcm_.publish(channels::kPath, &message);
}

void PlannerNode::publish_status(std::int64_t now) {
  const NavigationReport& report = executor_.report();
  const bool is_new = report.state != published_state_ || report.goal_id != published_goal_;
  const std::int64_t period = executor_.is_active() ? kActivePeriod : kIdlePeriod;
  if (!is_new && now >= last_status_ && now - last_status_ < period) {
    return;
  }
  published_state_ = report.state;
  published_goal_ = report.goal_id;
  last_status_ = now;
  navigation_status_t message{};
  message.utime = now;
  message.goal_id = report.goal_id;
  message.pose_index = report.stop_index;
  message.pose_count = report.stop_count;
  message.state = static_cast<std::int8_t>(report.state);
  message.cause = report.cause;
  if (report.target) {
    message.has_target = 1;
    message.x = report.target->pose.x;
    message.y = report.target->pose.y;
    message.has_theta = report.target->has_theta;
    message.theta = report.target->pose.theta;
  }
  message.distance_left = report.distance_left;
  message.path_sequence = executor_.path().sequence;
  message.replans = report.replans;
  lcm_.publish(channels::kNavigationStatus, &message);
}

}  // namespace luminav
