#include "drivers/p3dx/p3dx_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/robot_sentences.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStatusPeriod = 20'000;   // [us] 50 Hz
constexpr std::int64_t kGuardianPause = 50'000;  // [us] least, after the guardian is done with the line
constexpr std::int64_t kLongestGap = 250'000;    // [us] the process slept: what waits is outdated
constexpr double kAerosDistanceFactor = 0.485;   // [mm] p3dx on its older controller board
constexpr double kArcosDistanceFactor = 1.0;     // [mm] p3dx-sh
constexpr double kFastestRobot = 1.5;            // [m/s] whatever a controller claims
constexpr std::size_t kMotionQueue = 4;          // frames waiting on a line that is stuck

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

WheelWatchParams wheel_params(const RobotDescription& robot) {
  const double braking = robot.limits.linear / robot.limits.linear_deceleration;
  return {.wheel_base = robot.wheel_base, .dead_after = braking + 0.4, .runs_after = braking + 0.7};
}

}  // namespace

P3dxNode::P3dxNode(lcm::LCM& lcm, const P3dxConfig& config, const Clock& clock, OpenStream open_stream,
                   std::optional<CommandKey> key)
    : lcm_(lcm),
      config_(config),
      clock_(clock),
      link_(std::move(open_stream),
            {.baud = config.baud, .fast_baud = config.fast_baud, .assume_p3dx_sh = config.assume_p3dx_sh}),
      reckoning_(reckoning_params(config, "")),
      sonar_(static_cast<int>(config.robot.sonar.robot_from_sonar.size()), config.robot.sonar.maximum_range),
      gate_({config.command_timeout, config.robot.limits.linear, config.robot.limits.angular}),
      settings_(config.robot.limits, config.angular_deceleration),
      stop_(config.state_folder),
      motors_(config.enable_motors_at_start),
      wheels_(wheel_params(config.robot)),
      life_(config.guardian_silence, config.guardian_done_after),
      watched_(clock.utime()),
      subscriber_(lcm, key) {
  subscriber_.on(channels::kVelocityCommand, &P3dxNode::on_velocity_command, this);
  subscriber_.on(channels::kStop, &P3dxNode::on_stop, this);
  subscriber_.on(channels::kSupervision, &P3dxNode::on_supervision, this);
  subscriber_.on(channels::kMotorsCommand, &P3dxNode::on_motors_command, this);
}

void P3dxNode::on_velocity_command(const velocity_command_t& message) {
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
  if ((message.linear_x != 0.0 || message.angular_z != 0.0) && is_unsupervised(now)) {
    obey_stop(now, now, true, fmt::format("the driver: no page and no operator for {:.0f} s", config_.supervised));
    return;
  }
  command_motion(now);
  link_.flush(now);
}

void P3dxNode::on_stop(const stop_t& message) {
  obey_stop(wake(), message.id, message.engaged != 0, message.sender);
}

void P3dxNode::obey_stop(std::int64_t now, std::int64_t id, bool engaged, const std::string& sender) {
  if (stop_.request(id, engaged, sender)) {
    gate_.clear(now);
    writer_.restart();  // at once, however short ago the last change was
    command_motion(now);
    link_.flush(now);
  }
  stop_.save(now);
}

void P3dxNode::on_supervision(const supervision_t&) {
  watched_ = clock_.utime();
}

// Asked when a command would move the robot: one that stands needs nobody, and nobody comes back to a robot that
// drives.
bool P3dxNode::is_unsupervised(std::int64_t now) const {
  return config_.supervised > 0.0 && 1e-6 * static_cast<double>(now - watched_) > config_.supervised;
}

void P3dxNode::on_motors_command(const motors_command_t& message) {
  // Each request is repeated by its sender; a late copy of an older one, or a recording, must not undo the newest.
  if (message.id <= last_motors_command_) {
    return;
  }
  last_motors_command_ = message.id;
  const std::int64_t now = wake();
  gate_.clear(now);
  motors_.request(message.enable != 0);
  if (message.enable != 0) {
    wheels_.restart();
  }
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

std::int64_t P3dxNode::wake() {
  const std::int64_t now = clock_.utime();
  const bool slept = last_wake_ != 0 && now - last_wake_ > kLongestGap;
  const bool guardian_acted = life_.guardian_may_have_acted(now);
  last_wake_ = now;
  if (slept || guardian_acted) {
    // The guardian or the robot's watchdog has stopped the robot by now, and the first packet would resume its motion.
    gate_.clear(now);
    link_.drop_waiting();
    writer_.restart();
    command_motion(now);  // to stand, before any keep-alive
  }
  if (guardian_acted) {
    // Should the guardian have been held up too, it lets go of the line as this driver does: the robot must know
    // before.
    link_.flush(now);
    // Waiting until the robot's silence tells would take seconds; meanwhile the guardian still uses the line.
    link_.begin_anew(now, std::max(kGuardianPause, life_.guardian_done_at() - now),
                     "this driver was held up, its guardian has ended the session");
    life_.forget();
  }
  return now;
}

void P3dxNode::poll() {
  const std::int64_t now = wake();
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
  } else {
    send_settings(now);
  }
  command_motion(now);
  link_.flush(now);
  if (now >= next_status_) {
    next_status_ = now - next_status_ > 5 * kStatusPeriod ? now + kStatusPeriod : next_status_ + kStatusPeriod;
    publish_status(now);
  }
  stop_.save(now);
  life_.beat(clock_);
}

void P3dxNode::on_connected() {
  const std::int64_t now = clock_.utime();
  const MotionLimits& limits = config_.robot.limits;
  const ConfigurationPacket& robot = link_.configuration();
  reckoning_ = DeadReckoning(reckoning_params(config_, link_.identity().subclass));
  last_ = InformationPacket();
  sonar_.clear();
  motors_.on_connected();
  wheels_.restart();
  gate_.clear(now);
  gate_.set_limits(std::min(limits.linear, 1e-3 * robot.velocity_top),
                   std::min(limits.angular, radians(robot.turn_rate_top)));
  writer_.restart();
  link_.send(encode_command(ArcosCommand::kVelocity, 0));
  link_.send(encode_command(ArcosCommand::kTurnRate, 0));
  link_.send(encode_command(ArcosCommand::kSonar, 1));
  settings_.begin(gate_.params().maximum_linear, gate_.params().maximum_angular);
  send_settings(now);
}

void P3dxNode::send_settings(std::int64_t now) {
  for (std::vector<std::uint8_t>& frame :
       settings_.poll(now, link_.has_configuration() ? &link_.configuration() : nullptr)) {
    link_.send(std::move(frame));
  }
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
  if (!motors_were_wanted && motors_.wish()) {
    wheels_.restart();
  }
  watch_wheels(utime);
  publish_odometry(utime);
  publish_sonar();
}

void P3dxNode::watch_wheels(std::int64_t utime) {
  if (clock_.utime() - utime > kLongestGap) {
    wheels_.forget_motion();  // measured while this driver slept and told the robot something else
    return;
  }
  const bool was_well = wheels_.fault().empty();
  wheels_.update(last_, told_, utime);
  if (!was_well || wheels_.fault().empty()) {
    return;
  }
  // The robot's own control would drive a wheel that it does not see turn faster and faster: only without power it
  // stands.
  motors_.request(false);
  gate_.clear(clock_.utime());
  link_.send(encode_command(ArcosCommand::kEmergencyStop));
  link_.send(encode_command(ArcosCommand::kEnable, 0));
}

void P3dxNode::command_motion(std::int64_t now) {
  if (!link_.in_session() || link_.waiting_frames() >= kMotionQueue || !last_.motors_enabled) {
    return;
  }
  const bool stands = stop_.engaged() || standing_still_ || !held_because_.empty();
  const DriveVelocity wanted = stands ? DriveVelocity{} : gate_.velocity(now);
  told_ = wanted;
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
    return trouble_of(link_);
  }
  if (!wheels_.fault().empty()) {
    return wheels_.fault() + ": motors off until they are requested again";
  }
  if (!motors_.reason().empty()) {
    return motors_.reason();
  }
  if (stop_.engaged()) {
    return "stop requested by " + (stop_.sender().empty() ? "somebody" : stop_.sender());
  }
  if (!held_because_.empty()) {
    return held_because_;
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
    health.reason = trouble_of(link_);
  } else if (!wheels_.fault().empty()) {
    health.fault = true;
    health.reason = wheels_.fault() + ": motors off until they are requested again";
  } else if (!motors_.reason().empty()) {
    health.degraded = true;
    health.reason = motors_.reason();
  } else if (!stop_.trouble().empty()) {
    health.degraded = true;
    health.reason = stop_.trouble();
  } else if (link_.has_configuration() && 10 * last_.battery_voltage < robot.low_battery &&
             last_.battery_voltage > 0.0) {
    health.degraded = true;
    health.reason = "the battery is low";
  } else if (link_.has_configuration()) {
    health.reason = difference_from_file(robot, config_.robot, session_ != 0);
    health.degraded = !health.reason.empty();
  }
  return health;
}

void P3dxNode::hold(const std::string& why) {
  if (!why.empty() && held_because_.empty()) {
    writer_.restart();  // at once, however short ago the last change was
  }
  held_because_ = why;
}

bool P3dxNode::stand_still() {
  standing_still_ = true;
  constexpr double kStanding = 0.02;  // [m/s] and [rad/s]
  return !connected() || (std::abs(reckoning_.linear()) < kStanding && std::abs(reckoning_.angular()) < kStanding);
}

std::string P3dxNode::describe_line() const {
  return luminav::describe_line(link_, gate_.params().maximum_linear, config_.robot.limits.linear_deceleration);
}

void P3dxNode::shut_down() {
  link_.close_with({encode_command(ArcosCommand::kVelocity, 0), encode_command(ArcosCommand::kTurnRate, 0),
                    encode_command(ArcosCommand::kStop), encode_command(ArcosCommand::kEnable, 0),
                    encode_command(ArcosCommand::kSonar, 0), encode_command(ArcosCommand::kClose)});
  session_ = 0;
}

}  // namespace luminav
