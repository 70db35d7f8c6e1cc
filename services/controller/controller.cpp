#include "services/controller/controller.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kPatienceSearching = 3.0;   // [s] it waits for people while it can as well look elsewhere
constexpr double kPatienceWithThings = 1.5;  // [s] it waits for what never moved
constexpr double kPeopleWithin = 2.0;        // [m] something that comes nearer within it is a person
constexpr double kPeopleRemembered = 8.0;    // [s] since it saw somebody
constexpr double kSettleAfter = 1.5;         // [s] blocked within the tolerance counts as arrived
constexpr double kStuckAfterPeople = 30.0;   // [s] without progress while people come towards it
constexpr double kEscapePause = 3.0;         // [s] between two escapes
constexpr double kEscapedAfter = 1.0;        // [m] from the place of the first escape
constexpr int kMaxEscapes = 3;               // at one place; more is going in circles
constexpr double kCareWithin = 0.5;          // [m] of something that no map has
constexpr double kMinCare = 0.4;             // share of the robot's limits left when it is that near
constexpr double kNewsSlow = 0.45;           // [m] from something new ahead it drives at `kNewsSpeed`
constexpr double kNewsFree = 0.95;           // [m] and at full speed
constexpr double kNewsSpeed = 0.20;          // [m/s] stops within the tenth of a metre that people keep
constexpr double kNewsAge = 0.5;             // [s] since it was heard; a newer firing has the say then
constexpr double kHoldWithin = 0.35;         // [m] of something that no map has and that stops it: stands quite still
constexpr double kHoldPause = 1.0;           // [s] after that it tries by itself
constexpr double kPossible = 0.01;           // of all probability: zones of less likely poses would close every path
constexpr double kWallClearance = 0.28;      // [m] from the building's walls to where the robot's middle may be

/// Where the robot is when it comes to getting on: by the ceiling where that is known, since wheels that spin get
/// nowhere.
const Pose2& place_of(const ControlInput& input) {
  const bool by_ceiling = input.task == ControlTask::kFollow && input.world_from_robot;
  return by_ceiling ? *input.world_from_robot : input.odom_from_robot;
}

/// The same arc, slower.
DriveTwist at_speed(double speed, const DriveTwist& twist) {
  const double share = speed / std::abs(twist.linear);
  return {share * twist.linear, share * twist.angular};
}

bool is_still(const DriveTwist& twist) {
  return std::abs(twist.linear) < 0.02 && std::abs(twist.angular) < 0.04;
}

}  // namespace

Controller::Controller(const ControllerConfig& config)
    : config_(config),
      stop_logic_(config.robot, config.stop_logic),
      follower_(config.follower, stop_logic_),
      wander_(config.wander, config.robot.sonar, stop_logic_,
              CeilingForecast(config.building, config.walls, config.view_radius(), kWallClearance)),
      zones_(config.building.zones, config.robot.footprint),
      obstacles_(stop_logic_.footprint()),
      ramp_(config.robot.limits, config.jerk) {}

void Controller::set_zones(const std::vector<Zone>& zones) {
  zones_ = Zones(zones, config_.robot.footprint);
  quiet_ = nullptr;  // it pointed to one of those before
}

void Controller::forget_odometry() {
  wander_.clear();
  escape_.reset();
  standing_since_ = people_seen_ = 0;  // its stamps may be of another clock
  task_ = ControlTask::kNone;
}

void Controller::enter(ControlTask task, const ControlInput& input) {
  if (task == ControlTask::kWander && task_ != ControlTask::kWander) {
    wander_.clear();
    turn_search_.restart();
  }
  task_ = task;
  escape_.reset();
  escapes_ = 0;
  standing_since_ = 0;
  next_escape_ = 0;
  hold_since_ = next_hold_ = 0;
  progress_.restart(input.now, place_of(input));
}

// While it searches, a zone of any pose that is possible is one.
void Controller::look_around(const ControlInput& input) {
  std::vector<Eigen::Vector2d> walls;  // [m] robot frame
  if (input.world_from_robot && input.grid != nullptr) {
    walls = known_walls(*input.grid, *input.world_from_robot, config_.local_map.radius);
  }
  std::size_t zones = 0;
  double quiet = 0.0;  // probability of being in a quiet zone
  quiet_ = nullptr;
  if (input.world_from_robot) {
    zones = zones_.add_edges(*input.world_from_robot, config_.local_map.radius, walls);
    zones_.note_progress(input.world_from_robot->position());
  } else {
    for (const PoseAlternative& alternative : input.alternatives) {
      const Pose2 world_from_robot = alternative.world_from_odom * input.odom_from_robot;
      zones += alternative.weight < kPossible ? 0 : zones_.add_edges(world_from_robot, config_.local_map.radius, walls);
      if (const Zone* const zone = zones_.quiet_at(world_from_robot)) {
        quiet += alternative.weight;
        quiet_ = quiet > 0.5 ? zone : nullptr;
      }
    }
  }
  obstacles_.set(input.echoes, walls, zones, input.world_from_robot ? ZoneEdge::kCertain : ZoneEdge::kPossible);
}

DriveTwist Controller::by_lanes(const DriveTwist& wanted, const ControlInput& input, ControlOutput& output) const {
  constexpr double kTooSlow = 0.03;                            // [m/s] to get anywhere
  const bool is_by_hand = input.task == ControlTask::kTeleop;  // who steers may have a reason
  if (!input.world_from_robot || wanted.linear == 0.0 || is_by_hand) {
    return wanted;
  }
  const auto room = zones_.room_against(*input.world_from_robot, wanted.linear);
  if (!room) {
    return wanted;
  }
  const double deceleration = config_.robot.limits.linear_deceleration;
  const double reaction = config_.stop_logic.reaction_time;
  const double speed = deceleration * (std::sqrt(reaction * reaction + 2.0 * room->distance / deceleration) - reaction);
  if (speed >= std::abs(wanted.linear)) {
    return wanted;
  }
  output.reason = "not against the one-way zone " + room->zone->name;
  return speed < kTooSlow ? DriveTwist{0.0, wanted.angular} : at_speed(speed, wanted);
}

DriveTwist Controller::by_slow_zones(const DriveTwist& wanted, const ControlInput& input, ControlOutput& output) const {
  if (!input.world_from_robot || wanted.linear == 0.0) {
    return wanted;
  }
  const double speed = std::abs(wanted.linear);
  const double braking =
      speed * (config_.stop_logic.reaction_time + 0.5 * speed / config_.robot.limits.linear_deceleration);
  const Zone* const zone = zones_.slow_at(*input.world_from_robot, std::copysign(braking, wanted.linear));
  if (zone == nullptr || speed <= zone->speed) {
    return wanted;
  }
  if (output.reason.empty()) {
    output.reason = "slow zone " + zone->name;
  }
  return at_speed(zone->speed, wanted);
}

DriveTwist Controller::by_limit(const DriveTwist& wanted, const std::optional<SpeedLimit>& limit,
                                ControlOutput& output) {
  if (!limit || std::abs(wanted.linear) <= limit->max_speed) {
    return wanted;
  }
  if (output.reason.empty()) {
    output.reason = "slow for " + limit->sender;
  }
  return at_speed(limit->max_speed, wanted);
}

void Controller::keep_out_of_zones(const ControlInput& input, StopVerdict& verdict) const {
  const DriveTwist wanted = verdict.twist;
  if (input.world_from_robot) {
    verdict.twist = zones_.no_deeper(*input.world_from_robot, verdict.twist);
  } else {
    for (const PoseAlternative& alternative : input.alternatives) {
      if (alternative.weight >= kPossible) {
        const DriveTwist kept = zones_.no_deeper(alternative.world_from_odom * input.odom_from_robot, verdict.twist);
        // to turn on the spot takes the robot's middle nowhere, and without it a search ends at a zone's edge for good
        verdict.twist = kept.linear != 0.0 ? kept : DriveTwist{0.0, verdict.twist.angular};
      }
    }
  }
  if (verdict.twist.linear != wanted.linear || verdict.twist.angular != wanted.angular) {
    verdict.limited = true;
    verdict.blocked = verdict.blocked || (wanted.linear != 0.0 && verdict.twist.linear == 0.0);
    verdict.reason = "reaches into a keep-out zone and may only leave it";
  }
}

ControlOutput Controller::step(const ControlInput& input) {
  ControlOutput output;
  look_around(input);
  output.clearance = stop_logic_.clearance(obstacles_);
  const ControlTask task = input.halt ? ControlTask::kNone : input.task;
  if (task != task_) {
    enter(task, input);
  }
  if (input.halt) {
    ramp_.stop();
    output.state = ControlState::kStopped;
    output.reason = *input.halt;
    return output;
  }
  look_for_people(input.now);
  leave_what_it_touches(input);
  const double unknown = obstacles_.min_unknown_distance(10.0);
  const DriveTwist onward = by_lanes(with_care(wish(input, output), unknown), input, output);
  const DriveTwist allowed = by_slow_zones(onward, input, output);
  const DriveTwist wanted = by_limit(allowed, input.speed_limit, output);
  DriveTwist smooth = input.is_again ? ramp_.step_again(wanted) : ramp_.step(wanted, input.duration);
  if (escape_ && wanted.linear != 0.0) {
    // the arc that was found free, from the first step on: turning speeds up faster than driving
    smooth.angular = wanted.angular * smooth.linear / wanted.linear;
  }
  StopVerdict verdict = stop_logic_.judge(smooth, obstacles_, input.ages);
  keep_out_of_zones(input, verdict);
  hold_still(input.now, place_of(input), wanted, unknown, verdict);
  if (verdict.limited && is_still(verdict.twist)) {
    verdict.twist = {};  // who waits stands still: creeping into people is no waiting
  }
  ramp_.restart_from(verdict.twist);
  output.twist = verdict.twist;
  if (verdict.limited && (verdict.blocked || is_still(verdict.twist))) {
    output.reason = verdict.reason;
  }
  if (may_travel(task)) {
    StopVerdict of_wish = verdict;
    of_wish.blocked = (!is_still(wanted) || hold_since_ != 0) && is_still(verdict.twist) && verdict.limited;
    wait_or_escape(input, of_wish, output);
  }
  output.reason = output.reason.empty() ? input.ages.doubt : output.reason;
  if (const std::string inside = input.world_from_robot ? zones_.keep_out_at(*input.world_from_robot) : "";
      !inside.empty() && output.reason.empty()) {
    output.reason = "is inside the keep-out zone " + inside;
  }
  return output;
}

// What the building's map knows neither walks nor is news.
void Controller::look_for_people(std::int64_t now) {
  for (const ObstaclePoint& obstacle : obstacles_.measured()) {
    if (obstacle.approach > 0.0 && obstacle.position.norm() < kPeopleWithin) {
      people_seen_ = now;
    }
  }
}

bool Controller::has_met_people(std::int64_t now) const {
  return people_seen_ != 0 && seconds_between(people_seen_, now) < kPeopleRemembered;
}

// Something near that is on no map may be somebody about to move: slower, so that the next echo comes in time. What
// appears ahead where nothing was may be somebody who walks towards it, and his next echo comes a third of a second and
// half a metre later.
DriveTwist Controller::with_care(const DriveTwist& wanted, double nearest) const {
  const double share = std::clamp(nearest / kCareWithin, kMinCare, 1.0);
  // without a map all walls are unknown, but people do not stand still for long: it turns beside what stands
  const double news = task_ == ControlTask::kWander ? obstacles_.min_news_distance(10.0) : nearest;
  const double turn_share = std::clamp(news / kCareWithin, kMinCare, 1.0);
  double linear = share * config_.robot.limits.linear;
  for (const ObstaclePoint& obstacle : obstacles_.measured()) {
    if (obstacle.is_known || obstacle.has_stood || obstacle.age > kNewsAge) {
      continue;
    }
    const double come_nearer = obstacle.age * config_.robot.limits.linear;
    const double ahead = wanted.linear < 0.0 ? -obstacle.position.x() : obstacle.position.x();
    if (ahead < 0.5 * obstacle.position.norm()) {
      continue;
    }
    const double gap = stop_logic_.footprint().distance(obstacle.position) - come_nearer;
    const double fraction = std::clamp((gap - kNewsSlow) / (kNewsFree - kNewsSlow), 0.0, 1.0);
    const double max = config_.robot.limits.linear;
    linear = std::min(linear, max - (1.0 - fraction) * std::max(0.0, max - kNewsSpeed));
  }
  const double angular = turn_share * config_.robot.limits.angular;
  return {std::clamp(wanted.linear, -linear, linear), std::clamp(wanted.angular, -angular, angular)};
}

// Where something that is on no map stands in the way at arm's length it stands quite still for a while: people pass or
// turn away from a robot that waits, not from one that fidgets.
void Controller::hold_still(std::int64_t now, const Pose2& place, const DriveTwist& wanted, double nearest,
                            StopVerdict& verdict) {
  const bool drives_itself = task_ == ControlTask::kFollow && !escape_;
  // inching counts as stopped: somebody who may still step nearer never turns away
  const bool is_inching = std::abs(verdict.twist.linear) < 0.04 && std::abs(verdict.twist.angular) < 0.25;
  const bool is_stopped =
      verdict.limited && verdict.by_unknown && has_met_people(now) && !is_still(wanted) && is_inching;
  if (hold_since_ == 0 && drives_itself && is_stopped && nearest < kHoldWithin && now >= next_hold_) {
    hold_since_ = now;
  }
  if (hold_since_ == 0) {
    return;
  }
  const bool is_gone = nearest > kHoldWithin;
  if (!drives_itself || is_gone || seconds_between(hold_since_, now) > config_.patience) {
    if (is_gone) {
      // the path is free again: what happened before no longer counts
      progress_.restart(now, place);
      escapes_ = 0;
      standing_since_ = 0;
    }
    hold_since_ = 0;
    next_hold_ = now + microseconds_of(kHoldPause);
    return;
  }
  verdict.twist = {};
  verdict.limited = verdict.blocked = verdict.by_unknown = true;
  if (verdict.reason.empty()) {
    verdict.reason = "somebody or something stands in the way";
  }
}

DriveTwist Controller::wish(const ControlInput& input, ControlOutput& output) {
  output.reason = input.task_reason;
  switch (input.task) {
    case ControlTask::kNone:
      return {};
    case ControlTask::kTeleop:
      output.state = ControlState::kTeleop;
      return input.teleoperation;
    case ControlTask::kWander:
      if (!may_travel(input.task)) {
        return search(input, output);
      }
      output.state = ControlState::kWandering;
      break;
    case ControlTask::kFollow:
      if (!input.world_from_robot) {
        output.state = ControlState::kStopped;
        return {};
      }
      follow(input, output);
      if (output.follow.phase == FollowPhase::kAtGoal || output.follow.phase == FollowPhase::kNoPath) {
        escape_.reset();
        return {};
      }
      break;
  }
  if (escape_) {
    output.state = ControlState::kEscaping;
    output.reason = escape_->move.name;
    return escape_twist(input.now).value_or(DriveTwist{});
  }
  return input.task == ControlTask::kWander ? search(input, output) : output.follow.wanted;
}

bool Controller::may_travel(ControlTask task) const {
  return task == ControlTask::kFollow ||
         (task == ControlTask::kWander && config_.building.search == SearchManner::kWander && quiet_ == nullptr);
}

DriveTwist Controller::search(const ControlInput& input, ControlOutput& output) {
  const bool is_hushed = config_.building.search == SearchManner::kWander && quiet_ != nullptr;
  switch (is_hushed ? SearchManner::kTurn : config_.building.search) {
    case SearchManner::kWander:
      return wander_.step(
          {input.now, input.odom_from_robot, obstacles_, input.remembered, input.firings, input.alternatives});
    case SearchManner::kTurn: {
      const DriveTwist turn = turn_search_.step(input.odom_from_robot, config_.robot.limits.angular);
      output.state = turn_search_.is_over() ? ControlState::kIdle : ControlState::kTurning;
      output.reason = turn_search_.is_over()
                          ? "has looked all round and does not know where it is: tell it, or push it on"
                          : "looks round for ceiling lights that tell where it is";
      return turn;
    }
    case SearchManner::kStand:
      output.reason = "stands until it knows where it is: tell it, or push it on";
      return {};
  }
  return {};
}

void Controller::follow(const ControlInput& input, ControlOutput& output) {
  FollowSituation situation{.obstacles = obstacles_, .world_from_robot = *input.world_from_robot};
  situation.lane = zones_.lane_at(input.world_from_robot->position());
  situation.may_back = may_back(input.ages, config_.stop_logic);
  situation.duration = input.duration;
  situation.is_line_free = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return (input.grid == nullptr || is_line_free(*input.grid, from, to, config_.local_map)) &&
           zones_.is_line_free(from, to, config_.local_map.half_width);
  };
  output.follow = follower_.step(situation);
  switch (output.follow.phase) {
    case FollowPhase::kNoPath:
      output.state = ControlState::kIdle;
      output.reason = "there is no path to follow";
      break;
    case FollowPhase::kDriving:
      output.state = ControlState::kFollowing;
      break;
    case FollowPhase::kTurning:
      output.state = ControlState::kTurning;
      break;
    case FollowPhase::kAtGoal:
      output.state = ControlState::kAtGoal;
      break;
  }
}

// The arc of the escape that is due; nothing when it is over.
std::optional<DriveTwist> Controller::escape_twist(std::int64_t now) const {
  double passed = seconds_between(escape_->start, now);
  for (const EscapeMove::Arc& arc : escape_->move.arcs) {
    if (passed < arc.duration) {
      return arc.twist;
    }
    passed -= arc.duration;
  }
  return std::nullopt;
}

// To turn there would rub along it, or lead over an edge.
void Controller::leave_what_it_touches(const ControlInput& input) {
  const EscapeMove::Arc back{{-0.10, 0.0}, 1.2};
  const bool may_leave = may_travel(input.task) && may_back(input.ages, config_.stop_logic) &&
                         stop_logic_.is_free(back.twist, back.duration, obstacles_);
  if (input.ages.front_bumper && !escape_ && may_leave) {
    escape_ = Escape{{{back}, "backing from what it touched"}, input.now};
  }
}

void Controller::begin_escape(const ControlInput& input, bool by_unknown, ControlOutput& output) {
  EscapeSituation situation;
  situation.attempt = escapes_;
  situation.wish = output.follow.heading_error;
  situation.may_back = may_back(input.ages, config_.stop_logic);
  situation.by_unknown = by_unknown;
  situation.people_about = has_met_people(input.now);
  if (input.task == ControlTask::kWander) {
    situation.wish = situation.turn = wander_.turn_left();
    situation.people_about = false;  // it waited for them, and elsewhere it learns as much
  } else if (output.follow.phase == FollowPhase::kTurning) {
    situation.turn = output.follow.heading_error;
  }
  const auto move = choose_escape(situation, obstacles_, stop_logic_);
  // a path is not wrong because there is no room to turn towards it
  const bool keeps_to_its_path = move && move->frees_a_turn && escapes_ < kMaxEscapes;
  if (input.task == ControlTask::kWander && !keeps_to_its_path) {
    wander_.give_up(input.now, input.odom_from_robot);
  }
  if (move) {
    escape_ = Escape{*move, input.now};
    output.state = ControlState::kEscaping;
    output.reason = move->name;
  }
  if (escapes_++ == 0) {
    escape_place_ = place_of(input);
    escape_since_ = input.now;
  }
  next_escape_ = input.now + microseconds_of(kEscapePause);
}

double Controller::judge_progress(const ControlInput& input, const StopVerdict& verdict, ControlOutput& output) {
  if (escapes_ > 0 && distance(escape_place_, place_of(input)) > kEscapedAfter) {
    escapes_ = 0;
  }
  // to and fro between escape and obstacle is no progress
  const bool goes_in_circles = escapes_ >= kMaxEscapes;
  const double without_progress = progress_.update(input.now, place_of(input));
  output.seconds_without_progress = without_progress;
  // who drives freely again after the last escape is let drive: the next escape would only turn it back
  if (goes_in_circles && (verdict.blocked || without_progress > 0.5 * config_.stuck_after)) {
    output.seconds_without_progress = seconds_between(escape_since_, input.now);
  }
  return without_progress;
}

void Controller::end_escape(std::int64_t now, const StopVerdict& verdict) {
  if (escape_ && (verdict.blocked || !escape_twist(now))) {
    escape_.reset();
    standing_since_ = 0;
    next_escape_ = now + microseconds_of(kEscapePause);
  }
}

void Controller::wait_or_escape(const ControlInput& input, const StopVerdict& verdict, ControlOutput& output) {
  const bool has_work = output.state != ControlState::kAtGoal && output.state != ControlState::kIdle &&
                        output.state != ControlState::kStopped;
  if (!has_work) {
    progress_.restart(input.now, place_of(input));
    standing_since_ = 0;
    escapes_ = 0;
    return;
  }
  const double without_progress = judge_progress(input, verdict, output);
  const bool goes_in_circles = escapes_ >= kMaxEscapes;
  end_escape(input.now, verdict);
  if (escape_) {
    return;
  }
  if (!verdict.blocked) {
    standing_since_ = 0;
  } else if (standing_since_ == 0) {
    standing_since_ = input.now;
  }
  const double standing = standing_since_ == 0 ? 0.0 : seconds_between(standing_since_, input.now);
  const bool waits_for_people = verdict.by_unknown && has_met_people(input.now);
  if (verdict.blocked && waits_for_people && input.task == ControlTask::kFollow) {
    output.state = ControlState::kYielding;
  }
  if (standing > kSettleAfter && input.task == ControlTask::kFollow && input.world_from_robot &&
      follower_.is_within_tolerance(*input.world_from_robot)) {
    follower_.settle();
  }
  const double with_people = input.task == ControlTask::kWander ? kPatienceSearching : config_.patience;
  const double patience = waits_for_people ? with_people : kPatienceWithThings;
  const bool is_stuck = output.seconds_without_progress > config_.stuck_after;
  const bool is_waiting = standing > 0.0 && standing < patience;
  // who is only to turn where it stands does not leave its place for that
  const bool only_turns = input.task == ControlTask::kFollow && follower_.path().points.size() == 1;
  if ((standing > patience || without_progress > config_.stuck_after) && !is_waiting && !only_turns &&
      input.now >= next_escape_) {
    begin_escape(input, verdict.by_unknown, output);
  }
  // somebody who stands about is no reason to give up a goal, for a while
  const bool is_patient = has_met_people(input.now) && output.seconds_without_progress < kStuckAfterPeople;
  if (!escape_ && is_stuck && is_patient && input.task == ControlTask::kFollow && is_still(output.twist)) {
    output.state = ControlState::kYielding;
  } else if (!escape_ && is_stuck && !is_waiting) {
    output.state = ControlState::kStuck;
    if (output.reason.empty() && !goes_in_circles) {
      output.reason = "the way ahead leads nowhere";
    }
  }
  if (output.reason.empty() && goes_in_circles) {
    output.reason = "several attempts to get round led back here";
  }
}

}  // namespace luminav
