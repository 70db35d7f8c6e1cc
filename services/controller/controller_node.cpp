#include "services/controller/controller_node.hpp"

#include <algorithm>
#include <luminav/velocity_command_t.hpp>

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/controller/controller_messages.hpp"

namespace luminav {
namespace {

constexpr double kPlannerSilentAfter = 3.0;  // [s] without NAVIGATION_STATUS

constexpr std::int64_t kStatusPeriod = 100'000;   // [us] of CONTROL_STATUS
constexpr std::int64_t kStatusMissing = 150'000;  // [us] without ROBOT_STATUS: ODOMETRY becomes the tick

}  // namespace

ControllerNode::ControllerNode(lcm::LCM& lcm, const ControllerConfig& config, std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      commands_(lcm, key),
      subscriber_(lcm, key),
      zones_(config.building.zones, config.local_clock),
      controller_(config),
      obstacles_(config.robot, config.echo_memory) {
  subscriber_.on(channels::kPath, &ControllerNode::on_path, this);
  subscriber_.on(channels::kNavigationStatus, &ControllerNode::on_navigation_status, this);
  subscriber_.on(channels::kGridTile, &ControllerNode::on_grid_tile, this);
  subscriber_.on(channels::kPose, &ControllerNode::on_pose, this);
  subscriber_.on(channels::kHypotheses, &ControllerNode::on_hypotheses, this);
  subscriber_.on(channels::kOdometry, &ControllerNode::on_odometry, this);
  subscriber_.on(channels::kSonar, &ControllerNode::on_sonar, this);
  subscriber_.on(channels::kRobotStatus, &ControllerNode::on_robot_status, this);
  subscriber_.on(channels::kStop, &ControllerNode::on_stop, this);
  subscriber_.on(channels::kTeleopCommand, &ControllerNode::on_teleop_command, this);
  subscriber_.on(channels::kSpeedLimit, &ControllerNode::on_speed_limit, this);
}

Health ControllerNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  health.degraded = obstacles_.trust() != SonarTrust::kTrusted;
  health.reason = health.degraded ? obstacles_.reason() : subscriber_.last_reason();
  return health;
}

void ControllerNode::set_zones(const std::vector<Zone>& zones) {
  zones_.set(zones);
  controller_.set_zones(zones_.in_force());
}

void ControllerNode::on_path(const path_t& message) {
  std::string why;
  const std::optional<FollowedPath> path = path_of(message, why);
  if (!path) {
    subscriber_.drop(why);
    return;
  }
  const FollowedPath& now = controller_.path();
  if (now.goal_id == path->goal_id && now.sequence == path->sequence && !now.points.empty() &&
      now.points.size() == path->points.size()) {
    return;  // a repetition
  }
  controller_.set_path(*path);
}

void ControllerNode::on_navigation_status(const navigation_status_t& message) {
  navigation_ = {message, times_.tick};
}

void ControllerNode::on_grid_tile(const grid_tile_t& message) {
  if (!pose_.is_on_another_floor(message.floor) && map_.add(message) == TileMap::Result::kRefused) {
    subscriber_.drop("GRID_TILE that does not fit");
  }
}

void ControllerNode::on_pose(const pose_t& message) {
  std::string why;
  const PoseInput::Verdict verdict = pose_.take(message, why);
  if (verdict == PoseInput::Verdict::kRefused) {
    subscriber_.drop(why);
    return;
  }
  const bool is_moving = output_.twist.linear != 0.0 || output_.twist.angular != 0.0;
  if (verdict == PoseInput::Verdict::kNews && is_moving) {
    control(times_.tick);
    publish_command(times_.tick);
  }
}

void ControllerNode::on_hypotheses(const hypotheses_t& message) {
  std::string why;
  if (pose_.take(message, why) == PoseInput::Verdict::kRefused) {
    subscriber_.drop(why);
  }
}

void ControllerNode::on_odometry(const odometry_t& message) {
  std::string why;
  const PoseInput::Verdict verdict = pose_.take(message, why);
  if (verdict == PoseInput::Verdict::kRefused) {
    subscriber_.drop(why);
    return;
  }
  if (verdict == PoseInput::Verdict::kNewSession) {
    obstacles_.clear();
    controller_.forget_odometry();
  }
  if (!status_ || message.utime - times_.tick > kStatusMissing) {
    tick(message.utime);
  }
}

std::optional<PlacedGrid> ControllerNode::placed_grid() const {
  const std::optional<Pose2> world_from_odom = pose_.world_from_odom();
  return map_.received() > 0 && world_from_odom ? std::optional(PlacedGrid{map_.grid(), *world_from_odom})
                                                : std::nullopt;
}

void ControllerNode::on_sonar(const sonar_t& message) {
  obstacles_.take(message, pose_.odometry(), placed_grid(), [this](const char* why) { subscriber_.drop(why); });
}

void ControllerNode::on_robot_status(const robot_status_t& message) {
  const StampGuard::Verdict verdict = status_guard_.check(message.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("ROBOT_STATUS: older than the last");
    return;
  }
  if (verdict == StampGuard::Verdict::kNewSession) {
    times_ = {};
    navigation_.heard = 0;
    stream_ = {};  // the driver refuses commands of a session that is to begin
    teleoperation_.clear();
  }
  feel(message);
  status_ = message;
  tick(message.utime);
}

void ControllerNode::feel(const robot_status_t& status) {
  if (!is_blocked(status) || (status_ && is_blocked(*status_))) {
    return;
  }
  if (const std::optional<Pose2> place = pose_.odometry().odom_from_robot_at(status.utime)) {
    obstacles_.feel(status.utime, *place, output_.twist);
  }
}

void ControllerNode::on_stop(const stop_t& message) {
  if (stops_.take(message.id, message.engaged != 0, message.sender.substr(0, 64)) == StopRequests::Verdict::kOutdated) {
    subscriber_.drop("STOP: a release older than the stop");
  }
}

void ControllerNode::on_teleop_command(const teleop_command_t& message) {
  if (!teleoperation_.take(message, times_.tick)) {
    subscriber_.drop("TELEOP_COMMAND: repeated or not a number");
  }
}

void ControllerNode::on_speed_limit(const speed_limit_t& message) {
  const bool is_awake = times_.tick != 0;  // before that no stamp can be judged
  if (is_awake && !speed_limit_.take({message.utime, message.max_speed, message.sender.substr(0, 30)}, times_.tick)) {
    subscriber_.drop("SPEED_LIMIT: a speed that nobody drives by, or a stamp of another time");
  }
}

std::optional<std::string> ControllerNode::reason_to_halt(std::int64_t utime) const {
  if (stops_.engaged()) {
    return "a stop is engaged";
  }
  if (!status_ || seconds_between(status_->utime, utime) > config_.stop_logic.silent_after) {
    return "the robot's driver is silent";
  }
  if (!status_->connected) {
    return status_->reason.empty() ? "the robot is not connected" : "the robot is not connected: " + status_->reason;
  }
  if (status_->stop_engaged || status_->stop_button) {
    return status_->stop_button ? "the robot's stop button is pressed" : "a stop is engaged at the robot";
  }
  if (!status_->motors_enabled) {
    return "the motors are disabled";
  }
  if (status_->stall_left || status_->stall_right) {
    return status_->stall_left ? "the left wheel is blocked" : "the right wheel is blocked";
  }
  const RecentOdometry& odometry = pose_.odometry();
  if (odometry.empty() || seconds_between(odometry.newest().utime, utime) > config_.stop_logic.silent_after) {
    return "no odometry for half a second";
  }
  if (obstacles_.trust() == SonarTrust::kDead) {
    return obstacles_.reason();
  }
  return std::nullopt;
}

void ControllerNode::choose_task(std::int64_t utime, ControlInput& input) const {
  input.halt = reason_to_halt(utime);
  if (teleoperation_.is_steered(utime)) {
    input.task = ControlTask::kTeleop;
    if (const std::optional<DriveTwist> wanted = teleoperation_.at(utime)) {
      input.teleoperation = *wanted;
    } else {
      input.task_reason = "the person let go";
    }
    return;
  }
  const std::optional<navigation_status_t>& navigation = navigation_.newest;
  if (!navigation) {
    input.task_reason = "no goal yet";
    return;
  }
  if (seconds_between(navigation_.heard, utime) > kPlannerSilentAfter) {
    input.task_reason = "the planner is silent";
    return;
  }
  if (navigation->state == navigation_status_t::STATE_LOCALIZING) {
    input.task = ControlTask::kWander;
    input.task_reason = "looking for ceiling lights that tell where it is";
    return;
  }
  // WAITING may come with a path to the place of waiting, and is also what the planner makes of our own yielding
  const bool may_drive = navigation->state == navigation_status_t::STATE_FOLLOWING ||
                         navigation->state == navigation_status_t::STATE_WAITING ||
                         navigation->state == navigation_status_t::STATE_PLANNING;
  if (!may_drive) {
    return;
  }
  if (controller_.path().goal_id != navigation->goal_id || controller_.path().pose_index != navigation->pose_index) {
    input.task_reason = "waiting for the path";
    return;
  }
  if (controller_.path().points.empty()) {
    input.task_reason = "there is no path to follow";
    return;
  }
  input.task = ControlTask::kFollow;
  if (const std::optional<std::string> reason = pose_.reason_not_to_trust()) {
    input.task_reason = *reason;
  }
}

ControlInput ControllerNode::input_at(std::int64_t utime) {
  ControlInput input;
  input.now = utime;
  input.is_again = utime == times_.control;
  input.duration =
      times_.control == 0 ? config_.period : std::clamp(seconds_between(times_.control, utime), 0.001, 0.2);
  input.speed_limit = speed_limit_.at(utime);
  choose_task(utime, input);
  if (const std::optional<Pose2> place = pose_.odometry().odom_from_robot_at(utime)) {
    input.odom_from_robot = *place;
    if (const std::optional<Pose2> world = pose_.world_from_odom()) {
      input.world_from_robot = *world * *place;
      pose_.remember(*world);
      input.grid = map_.received() > 0 ? &map_.grid() : nullptr;
    }
    input.alternatives = pose_.possible();
    obstacles_.describe(utime, *place, input);
    input.ages.odometry = std::max(0.0, seconds_between(pose_.odometry().newest().utime, utime));
  }
  obstacles_.judge(utime, input.ages);
  input.ages.front_bumper = status_ && status_->bumpers_front != 0;
  input.ages.rear_bumper = status_ && status_->bumpers_rear != 0;
  return input;
}

void ControllerNode::control(std::int64_t utime) {
  output_ = controller_.step(input_at(utime));
  times_.control = utime;
}

void ControllerNode::tick(std::int64_t utime) {
  times_.tick = utime;
  if (zones_.tell(utime)) {
    controller_.set_zones(zones_.in_force());
  }
  if (stream_.session == 0) {
    stream_.session = utime;
  }
  const bool must_halt = reason_to_halt(utime).has_value() && output_.state != ControlState::kStopped;
  if (must_halt || utime < times_.control || seconds_between(times_.control, utime) > config_.period - 1e-3) {
    control(utime);
  }
  publish_command(utime);
  if (utime < times_.status || utime - times_.status >= kStatusPeriod - 1000) {
    publish_status(utime);
  }
}

void ControllerNode::publish_command(std::int64_t utime) {
  velocity_command_t command{};
  command.utime = utime;
  command.robot = config_.robot.name;
  command.session = stream_.session;
  command.sequence = stream_.sequence++;
  command.linear_x = output_.twist.linear;
  command.linear_y = 0.0;
  command.angular_z = output_.twist.angular;
  commands_.publish(channels::kVelocityCommand, command);
}

void ControllerNode::publish_status(std::int64_t utime) {
  times_.status = utime;
  control_status_t status = status_of(output_, controller_.path());
  status.utime = utime;
  status.sequence = status_sequence_++;
  status.stop_engaged = stops_.engaged();
  status.stop_id = stops_.id();
  lcm_.publish(channels::kControlStatus, &status);
}

}  // namespace luminav
