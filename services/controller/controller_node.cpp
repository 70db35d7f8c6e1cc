#include "services/controller/controller_node.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <luminav/velocity_command_t.hpp>

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/controller/controller_messages.hpp"
#include "services/controller/safety/facing_wall.hpp"

namespace luminav {
namespace {

constexpr double kPoseStaleAfter = 0.25;     // [s] against the newest odometry: two poses missing of ten a second
constexpr double kPlannerSilentAfter = 3.0;  // [s] without NAVIGATION_STATUS
constexpr double kTeleopSilentAfter = 0.3;   // [s] dead man
constexpr double kTeleopPause = 1.0;         // [s] after a person let go, before it drives by itself again

constexpr std::int64_t kStatusPeriod = 100'000;   // [us] of CONTROL_STATUS
constexpr std::int64_t kStatusMissing = 150'000;  // [us] without ROBOT_STATUS: ODOMETRY becomes the tick

std::string say_age(const char* what, double seconds) {
  std::array<char, 100> text{};
  std::snprintf(text.data(), text.size(), "%s is %.1f s old", what, seconds);
  return text.data();
}

}  // namespace

ControllerNode::ControllerNode(lcm::LCM& lcm, const ControllerConfig& config, std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      commands_(lcm, key),
      subscriber_(lcm, key),
      zones_(config.building.zones, config.local_clock),
      controller_(config),
      echoes_(config.robot.sonar, config.echo_memory),
      sonar_watch_(config.robot.sonar),
      touches_(config.robot) {
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
  health.degraded = sonar_watch_.trust() != SonarTrust::kTrusted;
  health.reason = health.degraded ? sonar_watch_.reason() : subscriber_.last_reason();
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
  navigation_ = message;
  navigation_heard_ = newest_tick_;
}

void ControllerNode::on_grid_tile(const grid_tile_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("GRID_TILE: impossible size or place");
    return;
  }
  if (pose_ && pose_->state == pose_t::STATE_TRACKING && pose_->floor != message.floor) {
    return;  // another floor's
  }
  if (!has_grid_ || message.map_session != map_session_ || !(geometry_of(message) == grid_.geometry)) {
    grid_ = OccupancyGrid(geometry_of(message));
    map_session_ = message.map_session;
    has_grid_ = true;
  }
  if (!apply_tile(message, grid_)) {
    subscriber_.drop("GRID_TILE: does not decompress to a tile");
  }
}

void ControllerNode::on_pose(const pose_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("POSE: not a pose");
    return;
  }
  if (!odometry_.empty() && odometry_.is_too_far_ahead(message.utime)) {
    subscriber_.drop("POSE: ahead of the odometry");  // it would never grow old
    return;
  }
  const bool is_news = !pose_ || message.fixture_utime != pose_->fixture_utime || message.state != pose_->state;
  pose_ = message;
  const bool is_moving = output_.twist.linear != 0.0 || output_.twist.angular != 0.0;
  if (is_news && is_moving) {
    control(newest_tick_);
    publish_command(newest_tick_);
  }
}

void ControllerNode::on_hypotheses(const hypotheses_t& message) {
  std::string why;
  const std::optional<Pose2> place = odometry_.odom_from_robot_at(message.utime);
  const std::optional<std::vector<PoseAlternative>> alternatives =
      alternatives_of(message, place.value_or(Pose2{}), why);
  if (!alternatives) {
    subscriber_.drop(why);
    return;
  }
  alternatives_ = place ? *alternatives : std::vector<PoseAlternative>{};
}

void ControllerNode::restart_odometry(const odometry_t& first) {
  alternatives_.clear();
  known_world_from_odom_.reset();
  odometry_.clear();
  echoes_.clear();
  sonar_watch_.forget_motion();
  touches_.clear();
  controller_.forget_odometry();
  odometry_.add(first);
  if (pose_ && (pose_->session != first.session || odometry_.is_too_far_ahead(pose_->utime))) {
    pose_.reset();
  }
}

void ControllerNode::on_odometry(const odometry_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("ODOMETRY: what no robot measures");
    return;
  }
  const StampGuard::Verdict verdict = odometry_guard_.check(message.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("ODOMETRY: older than the last");
    return;
  }
  if (verdict == StampGuard::Verdict::kNewSession ||
      (!odometry_.empty() && odometry_.newest().session != message.session)) {
    restart_odometry(message);
  } else {
    odometry_.add(message);
  }
  if (!status_ || message.utime - newest_tick_ > kStatusMissing) {
    tick(message.utime);
  }
}

void ControllerNode::on_sonar(const sonar_t& message) {
  const auto count = static_cast<std::size_t>(std::max(0, message.count));
  if (count != config_.robot.sonar.robot_from_sonar.size() || message.range.size() != count ||
      message.has_echo.size() != count || message.range_utime.size() != count) {
    subscriber_.drop("SONAR: not the number of discs of the robot's file");
    return;
  }
  if (odometry_.empty() || odometry_.newest().session != message.session) {
    return;  // the place of these readings is unknown
  }
  WallTest is_wall;
  const std::optional<Pose2> world = world_from_odom();
  if (world && has_grid_) {
    is_wall = [this, world_from_odom = *world](const Eigen::Vector2d& point, double distance) {
      return has_wall_near(grid_, world_from_odom * point, distance);
    };
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double range = message.range[i];
    if (message.range_utime[i] <= echoes_.newest()[i].utime) {
      continue;  // told already
    }
    const std::optional<Pose2> place = odometry_.odom_from_robot_at(message.range_utime[i]);
    if (!place && message.range_utime[i] < odometry_.began()) {
      continue;  // each SONAR tells of all discs: some fired before this process listened
    }
    const bool is_ahead = odometry_.is_too_far_ahead(message.range_utime[i]);
    if (!std::isfinite(range) || range < 0.0 || range > 50.0 || !place || is_ahead) {
      subscriber_.drop("SONAR: impossible range or stamp");
      continue;
    }
    const bool has_echo = message.has_echo[i] != 0 && range < config_.robot.sonar.maximum_range - 0.01;
    const SonarFiring firing{i, message.range_utime[i], range, has_echo, *place};
    echoes_.add(firing, is_wall);
    sonar_watch_.add(firing, world ? look_at_map(i, *world * *place) : SonarWatch::Place{});
  }
}

SonarWatch::Place ControllerNode::look_at_map(std::size_t disc, const Pose2& world_from_robot) const {
  const SonarRing& ring = config_.robot.sonar;
  const Pose2 world_from_sonar = world_from_robot * ring.robot_from_sonar[disc];
  const Cell cell = grid_.geometry.cell_at(world_from_sonar.position());
  if (!has_grid_ || !grid_.geometry.contains(cell) || grid_.prior[grid_.geometry.index(cell)] == Prior::kUnknown) {
    return {};
  }
  return {true, facing_wall(grid_, world_from_sonar, ring.half_angle, SonarWatch::kWall)};
}

void ControllerNode::on_robot_status(const robot_status_t& message) {
  const StampGuard::Verdict verdict = status_guard_.check(message.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    subscriber_.drop("ROBOT_STATUS: older than the last");
    return;
  }
  if (verdict == StampGuard::Verdict::kNewSession) {
    newest_tick_ = last_control_ = last_published_ = navigation_heard_ = 0;
    session_ = 0;  // the driver refuses commands of a session that is to begin
    command_sequence_ = 0;
    teleop_until_ = 0;
    teleop_.reset();
  }
  feel(message);
  status_ = message;
  tick(message.utime);
}

void ControllerNode::feel(const robot_status_t& status) {
  if (!is_blocked(status) || (status_ && is_blocked(*status_))) {
    return;
  }
  if (const std::optional<Pose2> place = odometry_.odom_from_robot_at(status.utime)) {
    touches_.add(status.utime, *place, output_.twist);
  }
}

void ControllerNode::on_stop(const stop_t& message) {
  if (stops_.take(message.id, message.engaged != 0, message.sender.substr(0, 64)) == StopRequests::Verdict::kOutdated) {
    subscriber_.drop("STOP: a release older than the stop");
  }
}

void ControllerNode::on_teleop_command(const teleop_command_t& message) {
  const bool is_repeated = teleop_ && teleop_->session == message.session && message.sequence <= teleop_->sequence;
  if (!all_finite({message.linear, message.angular}) || is_repeated) {
    subscriber_.drop("TELEOP_COMMAND: repeated or not a number");
    return;
  }
  teleop_ = message;
  if (std::abs(seconds_between(message.utime, newest_tick_)) <= kTeleopSilentAfter) {
    teleop_until_ = message.utime + microseconds_of(kTeleopSilentAfter);
  }
}

void ControllerNode::on_speed_limit(const speed_limit_t& message) {
  const bool is_awake = newest_tick_ != 0;  // before that no stamp can be judged
  if (is_awake && !speed_limit_.take({message.utime, message.max_speed, message.sender.substr(0, 30)}, newest_tick_)) {
    subscriber_.drop("SPEED_LIMIT: a speed that nobody drives by, or a stamp of another time");
  }
}

std::optional<std::string> ControllerNode::reason_not_to_trust_pose() const {
  if (!pose_ || odometry_.empty() || pose_->session != odometry_.newest().session) {
    return "the localizer has not spoken yet";
  }
  if (pose_->state != pose_t::STATE_TRACKING) {
    return "the pose is not known: " + pose_->reason;
  }
  if (odometry_.is_too_far_ahead(pose_->utime)) {  // it came before any odometry
    return "the pose is ahead of the odometry";
  }
  const double age = seconds_between(pose_->utime, odometry_.newest().utime);
  if (age > kPoseStaleAfter) {
    return say_age("the pose", age);
  }
  return std::nullopt;
}

std::optional<Pose2> ControllerNode::world_from_odom() const {
  if (reason_not_to_trust_pose()) {
    return std::nullopt;
  }
  const std::optional<Pose2> then = odometry_.odom_from_robot_at(pose_->utime);
  if (!then) {
    return std::nullopt;
  }
  return world_from_robot(*pose_) * then->inverse();
}

// A localizer that falls silent does not take the zones away with it: the last pose goes on by odometry.
std::vector<PoseAlternative> ControllerNode::possible_poses() const {
  const bool was_known = pose_ && pose_->state == pose_t::STATE_TRACKING && known_world_from_odom_;
  return was_known ? std::vector<PoseAlternative>{{*known_world_from_odom_, 1.0}} : alternatives_;
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
  if (odometry_.empty() || seconds_between(odometry_.newest().utime, utime) > config_.stop_logic.silent_after) {
    return "no odometry for half a second";
  }
  if (sonar_watch_.trust() == SonarTrust::kDead) {
    return sonar_watch_.reason();
  }
  return std::nullopt;
}

void ControllerNode::choose_task(std::int64_t utime, ControlInput& input) const {
  input.halt = reason_to_halt(utime);
  const auto pause = microseconds_of(kTeleopPause);
  if (utime <= teleop_until_ + pause) {
    input.task = ControlTask::kTeleop;
    if (teleop_ && utime <= teleop_until_) {
      input.teleoperation = {teleop_->linear, teleop_->angular};
    } else {
      input.task_reason = "the person let go";
    }
    return;
  }
  if (!navigation_) {
    input.task_reason = "no goal yet";
    return;
  }
  if (seconds_between(navigation_heard_, utime) > kPlannerSilentAfter) {
    input.task_reason = "the planner is silent";
    return;
  }
  if (navigation_->state == navigation_status_t::STATE_LOCALIZING) {
    input.task = ControlTask::kWander;
    input.task_reason = "looking for ceiling lights that tell where it is";
    return;
  }
  // WAITING may come with a path to the place of waiting, and is also what the planner makes of our own yielding
  const bool may_drive = navigation_->state == navigation_status_t::STATE_FOLLOWING ||
                         navigation_->state == navigation_status_t::STATE_WAITING ||
                         navigation_->state == navigation_status_t::STATE_PLANNING;
  if (!may_drive) {
    return;
  }
  if (controller_.path().goal_id != navigation_->goal_id || controller_.path().pose_index != navigation_->pose_index) {
    input.task_reason = "waiting for the path";
    return;
  }
  if (controller_.path().points.empty()) {
    input.task_reason = "there is no path to follow";
    return;
  }
  input.task = ControlTask::kFollow;
  if (const std::optional<std::string> reason = reason_not_to_trust_pose()) {
    input.task_reason = *reason;
  }
}

ControlInput ControllerNode::input_at(std::int64_t utime) {
  ControlInput input;
  input.now = utime;
  input.is_again = utime == last_control_;
  input.duration = last_control_ == 0 ? config_.period : std::clamp(seconds_between(last_control_, utime), 0.001, 0.2);
  input.speed_limit = speed_limit_.at(utime);
  choose_task(utime, input);
  if (const std::optional<Pose2> place = odometry_.odom_from_robot_at(utime)) {
    input.odom_from_robot = *place;
    if (const std::optional<Pose2> world = world_from_odom()) {
      input.world_from_robot = *world * *place;
      known_world_from_odom_ = world;
      input.grid = has_grid_ ? &grid_ : nullptr;
    }
    input.alternatives = possible_poses();
    input.echoes = echoes_.obstacles(utime, *place);
    if (input.task == ControlTask::kWander) {
      input.echoes = echoes_.obstacles_without_map(utime, *place);
      input.remembered = echoes_.remembered(utime, *place);
      input.firings = echoes_.newest();
      touches_.append(utime, *place, input.remembered);
    }
    touches_.append(utime, *place, input.echoes);
    input.ages.odometry = std::max(0.0, seconds_between(odometry_.newest().utime, utime));
  }
  judge_disc_ages(echoes_, utime, input.ages);
  input.ages.doubt = sonar_watch_.reason();
  input.ages.front_bumper = status_ && status_->bumpers_front != 0;
  input.ages.rear_bumper = status_ && status_->bumpers_rear != 0;
  return input;
}

void ControllerNode::control(std::int64_t utime) {
  output_ = controller_.step(input_at(utime));
  last_control_ = utime;
}

void ControllerNode::tick(std::int64_t utime) {
  newest_tick_ = utime;
  if (zones_.tell(utime)) {
    controller_.set_zones(zones_.in_force());
  }
  if (session_ == 0) {
    session_ = utime;
  }
  const bool must_halt = reason_to_halt(utime).has_value() && output_.state != ControlState::kStopped;
  if (must_halt || utime < last_control_ || seconds_between(last_control_, utime) > config_.period - 1e-3) {
    control(utime);
  }
  publish_command(utime);
  if (utime < last_published_ || utime - last_published_ >= kStatusPeriod - 1000) {
    publish_status(utime);
  }
}

void ControllerNode::publish_command(std::int64_t utime) {
  velocity_command_t command{};
  command.utime = utime;
  command.robot = config_.robot.name;
  command.session = session_;
  command.sequence = command_sequence_++;
  command.linear_x = output_.twist.linear;
  command.linear_y = 0.0;
  command.angular_z = output_.twist.angular;
  commands_.publish(channels::kVelocityCommand, command);
}

void ControllerNode::publish_status(std::int64_t utime) {
  last_published_ = utime;
  control_status_t status = status_of(output_, controller_.path());
  status.utime = utime;
  status.sequence = status_sequence_++;
  status.stop_engaged = stops_.engaged();
  status.stop_id = stops_.id();
  lcm_.publish(channels::kControlStatus, &status);
}

}  // namespace luminav
