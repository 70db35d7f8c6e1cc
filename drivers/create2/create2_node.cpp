#include "drivers/create2/create2_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStatusPeriod = 20'000;     // [us] 50 Hz
constexpr std::int64_t kOdometryPeriod = 100'000;  // [us] 10 Hz of the 67 Hz that the robot sends
constexpr std::int64_t kLongestGap = 250'000;      // [us] the process slept: what waits is outdated
constexpr std::int64_t kGuardianPause = 50'000;    // [us] least, after the guardian is done with the line

/// A period later, or from now on when that is long past.
std::int64_t advanced(std::int64_t due, std::int64_t period, std::int64_t now) {
  return now - due > 5 * period ? now + period : due + period;
}

std::int8_t charge_state(int charging_state) {
  switch (charging_state) {
    case 0:
      return robot_status_t::CHARGE_NONE;
    case 1:
      return robot_status_t::CHARGE_BALANCE;  // reconditioning
    case 2:
      return robot_status_t::CHARGE_BULK;
    case 3:
      return robot_status_t::CHARGE_FLOAT;
    default:
      return robot_status_t::CHARGE_UNKNOWN;
  }
}

}  // namespace

Create2Node::Create2Node(lcm::LCM& lcm, const Create2Config& config, const Clock& clock, OpenStream open_stream,
                         std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      clock_(clock),
      link_(std::move(open_stream)),
      odometry_({.wheel_base = config.robot.wheel_base}),
      gate_({config.command_timeout, config.robot.limits.linear, config.robot.limits.angular}),
      writer_(config.robot.limits, config.robot.wheel_base),
      stop_(config.state_folder),
      power_(config.enable_motors_at_start),
      life_(config.guardian_silence, config.guardian_done_after),
      watched_(clock.utime()),
      subscriber_(lcm, key) {
  subscriber_.on(channels::kVelocityCommand, &Create2Node::on_velocity_command, this);
  subscriber_.on(channels::kStop, &Create2Node::on_stop, this);
  subscriber_.on(channels::kSupervision, &Create2Node::on_supervision, this);
  subscriber_.on(channels::kMotorsCommand, &Create2Node::on_motors_command, this);
}

void Create2Node::on_velocity_command(const velocity_command_t& message) {
  const std::int64_t now = wake();
  if (message.robot != config_.robot.name) {
    subscriber_.drop("VELOCITY_COMMAND: meant for another robot");
    return;
  }
  const std::string why = gate_.offer({.utime = message.utime,
                                       .session = message.session,
                                       .sequence = message.sequence,
                                       .linear = message.linear_x,
                                       .sideways = message.linear_y,
                                       .angular = message.angular_z},
                                      now);
  if (!why.empty()) {
    subscriber_.drop("VELOCITY_COMMAND: " + why);
    return;
  }
  const bool unsupervised = config_.supervised > 0.0 && 1e-6 * static_cast<double>(now - watched_) > config_.supervised;
  if (unsupervised && (message.linear_x != 0.0 || message.angular_z != 0.0)) {
    obey_stop(now, now, true, fmt::format("the driver: no page and no operator for {:.0f} s", config_.supervised));
    return;
  }
  command_motion(now);
}

void Create2Node::on_stop(const stop_t& message) {
  obey_stop(wake(), message.id, message.engaged != 0, message.sender);
}

void Create2Node::obey_stop(std::int64_t now, std::int64_t id, bool engaged, const std::string& sender) {
  if (stop_.request(id, engaged, sender)) {
    gate_.clear(now);
    command_motion(now);
  }
  stop_.save(now);
}

void Create2Node::on_motors_command(const motors_command_t& message) {
  // Each request is repeated by its sender; a late copy of an older one, or a recording, must not undo the newest.
  if (message.id <= last_motors_command_) {
    return;
  }
  last_motors_command_ = message.id;
  const std::int64_t now = wake();
  gate_.clear(now);
  power_.request(message.enable != 0);
  if (link_.connected()) {
    link_.send(writer_.halt(now));
  }
}

std::int64_t Create2Node::wake() {
  const std::int64_t now = clock_.utime();
  const bool slept = last_wake_ != 0 && now - last_wake_ > kLongestGap;
  const bool guardian_acted = life_.guardian_may_have_acted(now);
  last_wake_ = now;
  if (slept || guardian_acted) {
    gate_.clear(now);
    link_.drop_waiting();
    if (link_.connected()) {
      link_.send(writer_.halt(now));
      link_.flush();
    }
  }
  if (guardian_acted) {
    link_.begin_anew(now, std::max(kGuardianPause, life_.guardian_done_at() - now),
                     "this driver was held up, its guardian has stopped the robot");
    life_.forget();
  }
  return now;
}

void Create2Node::poll() {
  const std::int64_t now = wake();
  const Create2Events events = link_.poll(now);
  impossible_readings_ += events.undecodable;
  if (events.connected) {
    session_ = 0;  // the wheels may have turned unseen
    power_.on_connected();
    writer_.restart();
    gate_.clear(now);
  }
  for (const TimedReading& received : events.readings) {
    on_reading(received, now);
  }
  if (!link_.connected()) {
    session_ = 0;
    gate_.clear(now);  // nobody sees what the robot does
  }
  command_motion(now);
  if (now >= next_status_) {
    next_status_ = advanced(next_status_, kStatusPeriod, now);
    publish_status(now);
  }
  stop_.save(now);
  life_.beat(clock_);
}

void Create2Node::on_reading(const TimedReading& received, std::int64_t now) {
  if (session_ == 0) {
    odometry_.restart();
  }
  const WheelOdometry::Verdict verdict = odometry_.update(received.reading, received.utime);
  if (verdict == WheelOdometry::Verdict::kRefused) {
    ++impossible_readings_;
    return;
  }
  last_ = received.reading;
  if (session_ == 0 || verdict == WheelOdometry::Verdict::kJumped) {
    session_ = now;
    odometry_sequence_ = 0;
    odometry_.measure_twist(received.utime);
  }
  if (hazards_.update(last_)) {
    gate_.clear(now);  // a command from before knows nothing of it
    link_.send(writer_.halt(now));
  }
  if (const auto mode = power_.update(last_, hazards_, now)) {
    link_.send(writer_.halt(now));
    link_.send(encode_opcode(*mode));
  }
  if (!PowerSupervisor::has_motors(last_)) {
    writer_.restart();
    if (!hazards_.sees_cliff()) {
      gate_.clear(now);  // whatever was asked of a robot without motors is not done later
    }
  }
  if (received.utime >= next_odometry_) {
    next_odometry_ = advanced(next_odometry_, kOdometryPeriod, received.utime);
    publish_odometry(received.utime);
  }
}

void Create2Node::command_motion(std::int64_t now) {
  if (!has_motors() || !link_.is_idle()) {
    link_.flush();
    return;
  }
  const bool stands = stop_.engaged() || standing_still_ || !held_because_.empty();
  const DriveVelocity wanted = stands ? DriveVelocity{} : gate_.velocity(now);
  if (hazards_.forbids(wanted)) {
    link_.send(writer_.halt(now));
  } else if (const auto command = writer_.poll(wanted, now)) {
    link_.send(*command);
  }
  link_.flush();
}

void Create2Node::publish_odometry(std::int64_t utime) {
  odometry_.measure_twist(utime);
  const Pose2& pose = odometry_.odom_from_robot();
  odometry_t message{};
  message.utime = utime;
  message.session = session_;
  message.sequence = odometry_sequence_++;
  message.x = pose.x;
  message.y = pose.y;
  message.theta = pose.theta;
  message.linear = odometry_.linear();
  message.angular = odometry_.angular();
  lcm_.publish(channels::kOdometry, &message);
}

void Create2Node::publish_status(std::int64_t now) {
  robot_status_t message{};
  message.utime = now;
  message.robot = config_.robot.name;
  message.session = session_;
  message.sequence = status_sequence_++;
  message.connected = connected() ? 1 : 0;
  message.stop_engaged = stop_.engaged() ? 1 : 0;
  message.command_fresh = has_motors() && !stop_.engaged() && gate_.is_fresh(now) ? 1 : 0;
  message.charge_state = robot_status_t::CHARGE_UNKNOWN;
  if (connected()) {
    message.motors_enabled = has_motors() ? 1 : 0;
    message.stall_left = last_.overcurrent_left ? 1 : 0;
    message.stall_right = last_.overcurrent_right ? 1 : 0;
    message.bumpers_front = hazards_.bumpers();
    message.battery_voltage = last_.voltage;
    message.charge_state = charge_state(last_.charging_state);
    message.linear = odometry_.linear();
    message.angular = odometry_.angular();
  }
  message.maximum_linear = gate_.params().maximum_linear;
  message.maximum_angular = gate_.params().maximum_angular;
  message.deceleration = config_.robot.limits.linear_deceleration;
  message.stop_id = stop_.id();
  message.motors_command_id = last_motors_command_;
  message.commands_refused = gate_.refused();
  message.bad_packets = link_.bad_frames();
  message.impossible_packets = impossible_readings_;
  message.reason = reason(now);
  lcm_.publish(channels::kRobotStatus, &message);
}

std::string Create2Node::reason(std::int64_t now) const {
  if (!connected()) {
    return link_.trouble();
  }
  if (!power_.reason().empty()) {
    return power_.reason();
  }
  if (stop_.engaged()) {
    return "stop requested by " + (stop_.sender().empty() ? "somebody" : stop_.sender());
  }
  if (!held_because_.empty()) {
    return held_because_;
  }
  if (std::string hazard = hazards_.reason(); !hazard.empty()) {
    return hazard;
  }
  if (last_.overcurrent_left || last_.overcurrent_right) {
    return last_.overcurrent_left && last_.overcurrent_right ? "both wheels are blocked"
           : last_.overcurrent_left                          ? "the left wheel is blocked"
                                                             : "the right wheel is blocked";
  }
  return gate_.is_fresh(now) ? "" : "no fresh command";
}

Health Create2Node::health() const {
  constexpr double kLowVoltage = 12.5;  // [V] of a battery of 14.4 V; it switches itself off at about 12
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  if (!connected()) {
    health.fault = true;
    health.reason = link_.trouble();
    return health;
  }
  const bool is_low = last_.voltage > 0.0 && last_.voltage < kLowVoltage;
  health.reason = !power_.reason().empty()   ? power_.reason()
                  : !stop_.trouble().empty() ? stop_.trouble()
                  : is_low                   ? "the battery is low"
                                             : "";
  health.degraded = !health.reason.empty();
  return health;
}

bool Create2Node::stand_still() {
  standing_still_ = true;
  constexpr double kStanding = 0.02;  // [m/s] and [rad/s]
  return !connected() || (std::abs(odometry_.linear()) < kStanding && std::abs(odometry_.angular()) < kStanding);
}

std::string Create2Node::describe_line() const {
  if (!connected()) {
    return link_.trouble();
  }
  return "connected; the robot has no watchdog: should driver and guardian both die while it drives, only an edge or "
         "its button stops it";
}

void Create2Node::shut_down() {
  std::vector<std::uint8_t> farewell = encode_halt();
  farewell.push_back(static_cast<std::uint8_t>(OiOpcode::kStart));
  link_.close_with(farewell);
  session_ = 0;
}

}  // namespace luminav
