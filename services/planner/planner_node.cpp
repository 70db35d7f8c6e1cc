#include "services/planner/planner_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <luminav/tile_request_t.hpp>

#include "services/common/configuration/building_edit.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/planner/planner_messages.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kActivePeriod =
    95'000;  // [us] NAVIGATION_STATUS at 10 Hz with a goal; below the 100 ms of ODOMETRY
constexpr std::int64_t kIdlePeriod = 950'000;       // [us] and at 1 Hz without
constexpr std::int64_t kPathPeriod = 950'000;       // [us] PATH is repeated: a datagram may get lost
constexpr std::int64_t kRequestPeriod = 2'000'000;  // [us] between TILE_REQUESTs
constexpr std::size_t kRememberedIds = 32;
constexpr std::size_t kMaxRequested = 200;
constexpr int kMaxStops = 1000;

}  // namespace

PlannerNode::PlannerNode(lcm::LCM& lcm, const PlannerConfig& config, std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      zones_(config.route.space.zones, config.local_clock),
      executor_(config.goals, config.route, config.doors),
      keeper_(config.state_folder, {config.boot, config.building}),
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
  health.reason = keeper_.error();
  health.degraded = !health.reason.empty();
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
  executor_.update(situation_.at(now_));  // a robot that knows where it is does not search first
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
      keeper_.accept(goal);
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
  keeper_.update(progress(), now_);
}

GoalProgressNow PlannerNode::progress() const {
  return {executor_.is_active(), executor_.stop_index(), executor_.is_paused()};
}

void PlannerNode::end() {
  keeper_.end(progress(), now_);
}

void PlannerNode::resume_stored_goal(std::int64_t now) {
  stored_goal_checked_ = true;
  const std::optional<StoredGoal> stored = keeper_.recall();
  if (!stored || executor_.is_active()) {
    return;
  }
  const goal_t& goal = stored->goal;
  keeper_.accept(goal);
  done_ids_.push_back(goal.id);
  const std::string why_ask = objection_to_resuming(*stored, {config_.boot, config_.building, now});
  const bool is_elsewhere = stored->kept.building != config_.building;  // its coordinates mean nothing here
  const std::string objection = is_elsewhere ? why_ask : objection_to(goal);
  if (!objection.empty()) {
    keeper_.leave(*stored);
    executor_.refuse(goal.id, "a kept goal is dropped: " + objection, now);
  } else if (why_ask.empty()) {
    executor_.resume_at(request_from(goal), stored->pose_index, now);
  } else {
    executor_.show_paused(request_from(goal), stored->pose_index, why_ask, now);
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
  const SituationInput::Verdict verdict = situation_.take(pose);
  if (verdict.is_refused) {
    subscriber_.drop("POSE older than the last");
    return;
  }
  heed(verdict, pose.utime);
}

void PlannerNode::on_robot_status(const robot_status_t& status) {
  const SituationInput::Verdict verdict = situation_.take(status);
  if (verdict.is_refused) {
    subscriber_.drop("ROBOT_STATUS older than the last");
    return;
  }
  heed(verdict, status.utime);
}

void PlannerNode::heed(const SituationInput::Verdict& verdict, std::int64_t utime) {
  if (verdict.is_new_session) {
    now_ = 0;
  }
  if (verdict.is_tick) {
    tick(utime);
  }
}

void PlannerNode::on_control_status(const control_status_t& status) {
  situation_.take(status, now_);
}

// ---------------------------------------------------------------------------------------------------- the tick

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
  situation_.begin_tick(utime);
  request_tiles(utime);
  executor_.update(situation_.at(utime));
  situation_.end_tick();
  keeper_.update(progress(), now_);
  publish_path(utime);
  publish_status(utime);
}

void PlannerNode::request_tiles(std::int64_t now) {
  const std::int64_t last = tile_requests_.last;
  if (map_.is_complete() || (last != 0 && now >= last && now - last < kRequestPeriod)) {
    return;
  }
  tile_requests_.last = now;
  tile_request_t request{};
  request.utime = now;
  request.id = ++tile_requests_.id;
  map_.missing(kMaxRequested, request.tile_column, request.tile_row);
  request.count = static_cast<std::int32_t>(request.tile_column.size());  // none known yet: all of them
  lcm_.publish(channels::kTileRequest, &request);
}

void PlannerNode::publish_path(std::int64_t now) {
  const GoalPath& path = executor_.path();
  const bool is_new = path.sequence != published_.path_sequence;
  const bool is_due = executor_.is_active() && (now < published_.path_at || now - published_.path_at >= kPathPeriod);
  if (path.sequence == 0 || (!is_new && !is_due)) {
    return;
  }
  published_.path_sequence = path.sequence;
  published_.path_at = now;
  const path_t message = path_message(path, now);
  lcm_.publish(channels::kPath, &message);
}

void PlannerNode::publish_status(std::int64_t now) {
  const NavigationReport& report = executor_.report();
  const bool is_new = report.state != published_.state || report.goal_id != published_.goal_id;
  const std::int64_t period = executor_.is_active() ? kActivePeriod : kIdlePeriod;
  if (!is_new && now >= published_.status_at && now - published_.status_at < period) {
    return;
  }
  published_.state = report.state;
  published_.goal_id = report.goal_id;
  published_.status_at = now;
  const navigation_status_t message = navigation_message(report, executor_.path(), now);
  lcm_.publish(channels::kNavigationStatus, &message);
}

}  // namespace luminav
