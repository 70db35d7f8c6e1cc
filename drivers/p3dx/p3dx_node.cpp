#include "drivers/p3dx/p3dx_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "drivers/p3dx/arcos_commands.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStatusPeriod = 20'000;       // [us] 50 Hz
constexpr std::int64_t kGuardianPause = 50'000;      // [us] least, after the guardian is done with the line
constexpr std::int64_t kLongestGap = 250'000;        // [us] the process slept: what waits is outdated
constexpr double kAerosDistanceFactor = 0.485;       // [mm] p3dx on its older controller board
constexpr double kArcosDistanceFactor = 1.0;         // [mm] p3dx-sh
constexpr double kFastestRobot = 1.5;                // [m/s] whatever a controller claims
constexpr std::int64_t kSettingsPeriod = 1'000'000;  // [us]
constexpr int kMostSettings = 20;                    // then the robot does not want to
constexpr std::size_t kMotionQueue = 4;              // frames waiting on a line that is stuck

int in_mm(double metres) {
  return static_cast<int>(std::lround(1000.0 * metres));
}
int in_degrees(double angle) {
  return static_cast<int>(std::lround(degrees(angle)));
}

/// Packets that were held back arrive together; each was taken at least a cycle [us] before the next.
void spread_stamps(std::vector<ReceivedInformation>& packets, std::int64_t cycle) {
  for (std::size_t i = packets.size(); i-- > 1;) {
    packets[i - 1].utime = std::min(packets[i - 1].utime, packets[i].utime - cycle);
  }
}

DeadReckoningParams reckoning_params(const P3dxConfig& config, const std::string& subclass) {
  DeadReckoningParams params;
  params.maximum_speed = kFastestRobot;
  params.distance_factor = config.distance_factor > 0.0 ? config.distance_factor
                           : subclass == "p3dx"         ? kAerosDistanceFactor
                                                        : kArcosDistanceFactor;
  return params;
}

}  // namespace

P3dxNode::P3dxNode(lcm::LCM& lcm, const P3dxConfig& config, const Clock& clock, OpenStream open_stream)
    : lcm_(lcm),
      config_(config),
      clock_(clock),
      link_(std::move(open_stream),
            {.baud = config.baud, .fast_baud = config.fast_baud, .assume_p3dx_sh = config.assume_p3dx_sh}),
      reckoning_(reckoning_params(config, "")),
      sonar_(static_cast<int>(config.robot.sonar.robot_from_sonar.size()), config.robot.sonar.maximum_range),
      gate_({config.command_timeout, config.robot.limits.linear, config.robot.limits.angular}),
      stop_(config.state_folder),
      motors_(config.enable_motors_at_start),
      subscriber_(lcm) {
  subscriber_.on(channels::kVelocityCommand, &P3dxNode::on_velocity_command, this);
  subscriber_.on(channels::kStop, &P3dxNode::on_stop, this);
  subscriber_.on(channels::kMotorsCommand, &P3dxNode::on_motors_command, this);
}

void P3dxNode::on_velocity_command(const velocity_command_t& message) {
  const std::int64_t now = clock_.utime();
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
  command_motion(now);
  link_.flush(now);
}

void P3dxNode::on_stop(const stop_t& message) {
  const std::int64_t now = clock_.utime();
  if (stop_.request(message.id, message.engaged != 0, message.sender)) {
    gate_.clear(now);
    writer_.restart();  // at once, however short ago the last change was
    command_motion(now);
    link_.flush(now);
  }
}

void P3dxNode::on_motors_command(const motors_command_t& message) {
  // Each request is repeated by its sender; a late copy of an older one must not undo the newest.
  constexpr std::size_t kRemembered = 64;
  if (std::find(motors_commands_seen_.begin(), motors_commands_seen_.end(), message.id) !=
      motors_commands_seen_.end()) {
    return;
  }
  motors_commands_seen_.push_back(message.id);
  if (motors_commands_seen_.size() > kRemembered) {
    motors_commands_seen_.pop_front();
  }
  last_motors_command_ = message.id;
  const std::int64_t now = clock_.utime();
  gate_.clear(now);
  motors_.request(message.enable != 0);
  if (link_.connected()) {
    // VEL 0 and RVEL 0 go first: some robots have run wild right after ENABLE.
    writer_.restart();
    command_motion(now);
    if (message.enable == 0) {
      link_.send(encode_command(ArcosCommand::kEnable, 0));
    }
    link_.flush(now);
  }
}

void P3dxNode::poll() {
  const std::int64_t now = clock_.utime();
  if (last_poll_ != 0 && now - last_poll_ > kLongestGap) {
    // The guardian or the robot's watchdog has stopped the robot by now, and the first packet would resume its motion.
    gate_.clear(now);
    link_.drop_waiting();
    writer_.restart();
    command_motion(now);  // to stand, before any keep-alive
    const bool guardian_acted = 1e-6 * static_cast<double>(now - last_poll_) > config_.guardian_silence;
    if (config_.guardian_done_after > 0.0 && guardian_acted) {
      // Waiting until the robot's silence tells would take seconds; meanwhile the guardian still uses the line.
      const auto done = last_poll_ + static_cast<std::int64_t>(1e6 * config_.guardian_done_after);
      link_.begin_anew(now, std::max(kGuardianPause, done - now),
                       "this driver was held up, its guardian has ended the session");
    }
  }
  last_poll_ = now;
  LinkEvents events = link_.poll(now);
  spread_stamps(events.information, std::int64_t{1000} * link_.configuration().information_cycle);
  impossible_packets_ += events.undecodable;
  if (events.connected) {
    on_connected();
  }
  for (const ReceivedInformation& received : events.information) {
    on_information(received);
  }
  if (!link_.connected()) {
    gate_.clear(now);  // nobody sees what the robot does
  }
  if (!link_.in_session()) {
    session_ = 0;
  } else if (link_.has_configuration() && !settings_in_force() && settings_sent_ < kMostSettings &&
             now - settings_sent_at_ > kSettingsPeriod) {
    send_settings(now);  // nothing is acknowledged, and some of it was lost
  }
  command_motion(now);
  link_.flush(now);
  if (now >= next_status_) {
    next_status_ = now - next_status_ > 5 * kStatusPeriod ? now + kStatusPeriod : next_status_ + kStatusPeriod;
    publish_status(now);
  }
}

void P3dxNode::on_connected() {
  const std::int64_t now = clock_.utime();
  const MotionLimits& limits = config_.robot.limits;
  const ConfigurationPacket& robot = link_.configuration();
  reckoning_ = DeadReckoning(reckoning_params(config_, link_.identity().subclass));
  last_ = InformationPacket();
  sonar_.clear();
  motors_.on_connected();
  gate_.clear(now);
  gate_.set_limits(std::min(limits.linear, 1e-3 * robot.velocity_top),
                   std::min(limits.angular, radians(robot.turn_rate_top)));
  writer_.restart();
  link_.send(encode_command(ArcosCommand::kVelocity, 0));
  link_.send(encode_command(ArcosCommand::kTurnRate, 0));
  link_.send(encode_command(ArcosCommand::kSonar, 1));
  settings_sent_ = 0;
  send_settings(now);
}

void P3dxNode::send_settings(std::int64_t now) {
  const MotionLimits& limits = config_.robot.limits;
  // One degree/s is the step of turn rates: rounded up, so that the limit itself can be reached.
  const int turn_rate = static_cast<int>(std::ceil(degrees(gate_.params().maximum_angular)));
  for (const auto& [command, value] : {
           std::pair{ArcosCommand::kSetMaximumVelocity, in_mm(gate_.params().maximum_linear)},
           std::pair{ArcosCommand::kSetAcceleration, in_mm(limits.linear_acceleration)},
           std::pair{ArcosCommand::kSetAcceleration, -in_mm(limits.linear_deceleration)},
           std::pair{ArcosCommand::kSetMaximumTurnRate, turn_rate},
           std::pair{ArcosCommand::kSetTurnAcceleration, in_degrees(limits.angular_acceleration)},
           std::pair{ArcosCommand::kSetTurnAcceleration, -in_degrees(config_.angular_deceleration)},
       }) {
    link_.send(encode_command(command, value));
  }
  link_.send(encode_command(ArcosCommand::kConfiguration));  // reads them back
  ++settings_sent_;
  settings_sent_at_ = now;
}

bool P3dxNode::settings_in_force() const {
  const ConfigurationPacket& robot = link_.configuration();
  const MotionLimits& limits = config_.robot.limits;
  return robot.velocity_maximum == in_mm(gate_.params().maximum_linear) &&
         robot.acceleration == std::min(in_mm(limits.linear_acceleration), robot.acceleration_top) &&
         robot.deceleration == std::min(in_mm(limits.linear_deceleration), robot.acceleration_top);
}

void P3dxNode::on_information(const ReceivedInformation& received) {
  const std::int64_t now = clock_.utime();
  const bool begins = session_ == 0;
  if (begins) {
    reckoning_.restart();
  }
  // The order of stamps is kept, and none comes twice.
  const std::int64_t measured = received.utime - std::int64_t{1000} * link_.configuration().kinematics_delay;
  const std::int64_t utime = std::max(measured, reckoning_.utime() + 1);
  const DeadReckoning::Verdict verdict = reckoning_.update(received.packet, utime);
  if (verdict == DeadReckoning::Verdict::kRefused) {
    ++impossible_packets_;
    return;
  }
  if (begins || verdict == DeadReckoning::Verdict::kJumped) {
    session_ = now;
    odometry_sequence_ = 0;
    sonar_sequence_ = 0;
    sonar_.clear();
  }
  last_ = received.packet;
  sonar_.update(received.packet, utime, std::int64_t{1000} * link_.configuration().sonar_cycle);
  const bool motors_were_wanted = motors_.wish();
  if (const auto enable = motors_.update(received.packet, now)) {
    writer_.restart();
    link_.send(encode_command(ArcosCommand::kVelocity, 0));
    link_.send(encode_command(ArcosCommand::kTurnRate, 0));
    link_.send(encode_command(ArcosCommand::kEnable, *enable ? 1 : 0));
  }
  if (motors_were_wanted != motors_.wish() || !received.packet.motors_enabled) {
    gate_.clear(now);  // whatever was asked of a robot without motors is not done later
  }
  publish_odometry(utime);
  publish_sonar();
}

void P3dxNode::command_motion(std::int64_t now) {
  if (!link_.in_session() || link_.waiting_frames() >= kMotionQueue || !last_.motors_enabled) {
    return;
  }
  const bool stands = stop_.engaged() || standing_still_;
  const DriveVelocity wanted = stands ? DriveVelocity{} : gate_.velocity(now);
  for (std::vector<std::uint8_t>& frame : writer_.poll(wanted, now)) {
    link_.send(std::move(frame));
  }
}

void P3dxNode::publish_odometry(std::int64_t utime) {
  const Pose2 pose = reckoning_.odom_from_robot();
  odometry_t message{};
  message.utime = utime;
  message.session = session_;
  message.sequence = odometry_sequence_++;
  message.x = pose.x;
  message.y = pose.y;
  message.theta = pose.theta;
  message.linear = reckoning_.linear();
  message.angular = reckoning_.angular();
  lcm_.publish(channels::kOdometry, &message);
}

void P3dxNode::publish_sonar() {
  sonar_t message = sonar_.message();
  message.session = session_;
  message.sequence = sonar_sequence_++;
  lcm_.publish(channels::kSonar, &message);
}

void P3dxNode::publish_status(std::int64_t now) {
  const bool connected = link_.connected() && session_ != 0;
  const ConfigurationPacket& robot = link_.configuration();
  robot_status_t message{};
  message.utime = now;
  message.robot = config_.robot.name;
  message.session = session_;
  message.sequence = status_sequence_++;
  message.connected = connected ? 1 : 0;
  message.stop_engaged = stop_.engaged() ? 1 : 0;
  message.command_fresh = connected && !stop_.engaged() && gate_.is_fresh(now) ? 1 : 0;
  if (connected) {
    message.motors_enabled = last_.motors_enabled ? 1 : 0;
    message.stop_button = last_.stop_button ? 1 : 0;
    message.stall_left = last_.stall_left ? 1 : 0;
    message.stall_right = last_.stall_right ? 1 : 0;
    message.bumpers_front = last_.bumpers_front;
    message.bumpers_rear = last_.bumpers_rear;
    message.battery_voltage = last_.battery_voltage;
    message.linear = reckoning_.linear();
    message.angular = reckoning_.angular();
  }
  const int charge = last_.charge_state.value_or(0xFF);
  message.charge_state = connected && charge <= robot_status_t::CHARGE_BALANCE ? static_cast<std::int8_t>(charge)
                                                                               : robot_status_t::CHARGE_UNKNOWN;
  message.maximum_linear = gate_.params().maximum_linear;
  message.maximum_angular = gate_.params().maximum_angular;
  message.deceleration =
      link_.has_configuration() ? 1e-3 * robot.deceleration : config_.robot.limits.linear_deceleration;
  message.stop_id = stop_.id();
  message.motors_command_id = last_motors_command_;
  message.commands_refused = gate_.refused();
  message.bad_packets = link_.parser().bad_packets();
  message.impossible_packets = impossible_packets_;
  message.reason = reason(now);
  lcm_.publish(channels::kRobotStatus, &message);
}

std::string P3dxNode::reason(std::int64_t now) const {
  if (!link_.connected() || session_ == 0) {
    return link_.trouble().empty() ? "the robot does not answer" : link_.trouble();
  }
  if (!motors_.reason().empty()) {
    return motors_.reason();
  }
  if (stop_.engaged()) {
    return "stop requested by " + (stop_.sender().empty() ? "somebody" : stop_.sender());
  }
  if (last_.stall_left || last_.stall_right) {
    return last_.stall_left && last_.stall_right ? "both wheels are blocked"
           : last_.stall_left                    ? "the left wheel is blocked"
                                                 : "the right wheel is blocked";
  }
  return gate_.is_fresh(now) ? "" : "no fresh command";
}

Health P3dxNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  const ConfigurationPacket& robot = link_.configuration();
  if (!connected()) {
    health.fault = true;
    health.reason = link_.trouble().empty() ? "the robot does not answer" : link_.trouble();
  } else if (!motors_.reason().empty()) {
    health.degraded = true;
    health.reason = motors_.reason();
  } else if (link_.has_configuration() && 10 * last_.battery_voltage < robot.low_battery &&
             last_.battery_voltage > 0.0) {
    health.degraded = true;
    health.reason = "the battery is low";
  } else if (link_.has_configuration()) {
    health.reason = compare_with_robot_file();
    health.degraded = !health.reason.empty();
  }
  return health;
}

std::string P3dxNode::compare_with_robot_file() const {
  const ConfigurationPacket& robot = link_.configuration();
  const MotionLimits& limits = config_.robot.limits;
  if (1e-3 * robot.velocity_top < limits.linear) {
    return fmt::format("the robot's file allows {:.2f} m/s, the robot itself {:.2f} m/s", limits.linear,
                       1e-3 * robot.velocity_top);
  }
  if (std::abs(robot.deceleration - in_mm(limits.linear_deceleration)) > 1 && session_ != 0) {
    return fmt::format("the robot brakes with {:.2f} m/s^2, its file says {:.2f} m/s^2", 1e-3 * robot.deceleration,
                       limits.linear_deceleration);
  }
  constexpr std::size_t kDiscsPerArray = 8;
  if (robot.has_rear_sonar == 0 && config_.robot.sonar.robot_from_sonar.size() > kDiscsPerArray) {
    return "the robot has no rear sonars, its file has some: they never echo";
  }
  return {};
}

bool P3dxNode::stand_still() {
  standing_still_ = true;
  constexpr double kStanding = 0.02;  // [m/s] and [rad/s]
  return !connected() || (std::abs(reckoning_.linear()) < kStanding && std::abs(reckoning_.angular()) < kStanding);
}

std::string P3dxNode::describe_line() const {
  if (!connected()) {
    return link_.trouble().empty() ? "the robot does not answer" : link_.trouble();
  }
  const RobotIdentity& robot = link_.identity();
  const ConfigurationPacket& stored = link_.configuration();
  const std::string who = fmt::format("connected with \"{}\" ({})", robot.name, robot.subclass);
  if (!link_.has_configuration()) {
    return who + "; it does not tell its configuration, that of a p3dx-sh is assumed";
  }
  if (stored.watchdog == 0) {
    return who + "; its watchdog is OFF: without driver and guardian it would not stop";
  }
  const double speed = gate_.params().maximum_linear;
  const double way = speed * 1e-3 * stored.watchdog + 0.5 * speed * speed / config_.robot.limits.linear_deceleration;
  return fmt::format(
      "{}; should driver and guardian both die at {:.1f} m/s, its watchdog of {} ms stops it after {:.1f} m", who,
      speed, stored.watchdog, way);
}

void P3dxNode::shut_down() {
  link_.close_with({encode_command(ArcosCommand::kVelocity, 0), encode_command(ArcosCommand::kTurnRate, 0),
                    encode_command(ArcosCommand::kStop), encode_command(ArcosCommand::kEnable, 0),
                    encode_command(ArcosCommand::kSonar, 0), encode_command(ArcosCommand::kClose)});
  session_ = 0;
}

}  // namespace luminav
