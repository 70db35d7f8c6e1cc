#include "drivers/p3dx/p3dx_node.hpp"

#include <algorithm>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/robot_sentences.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kLongestGap = 250'000;   // [us] the process slept: what it measured is outdated
constexpr double kAerosDistanceFactor = 0.485;  // [mm] p3dx on its older controller board
constexpr double kArcosDistanceFactor = 1.0;    // [mm] p3dx-sh
constexpr double kFastestRobot = 1.5;           // [m/s] whatever a controller claims
constexpr std::size_t kMotionQueue = 4;         // frames waiting on a line that is stuck

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
      settings_(config.robot.limits, config.angular_deceleration),
      motors_(config.enable_motors_at_start),
      wheels_(wheel_params(config.robot)),
      desk_(lcm, config, clock, key, *this) {}

void P3dxNode::follow(std::int64_t now) {
  command_motion(now);
  link_.flush(now);
}

void P3dxNode::follow_stop(std::int64_t now) {
  writer_.restart();  // at once, however short ago the last change was
  command_motion(now);
  link_.flush(now);
}

void P3dxNode::switch_motors(std::int64_t now, bool enable) {
  motors_.request(enable);
  if (enable) {
    wheels_.restart();
  }
  if (link_.connected()) {
    // VEL 0 and RVEL 0 go first: some robots have run wild right after ENABLE.
    writer_.restart();
    command_motion(now);
    if (!enable) {
      link_.send(encode_command(ArcosCommand::kEnable, 0));
    }
    link_.flush(now);
  }
}

void P3dxNode::stand_after_gap(std::int64_t now) {
  link_.drop_waiting();
  writer_.restart();
  command_motion(now);  // to stand, before any keep-alive
}

void P3dxNode::begin_anew(std::int64_t now, std::int64_t pause) {
  // Should the guardian have been held up too, it lets go of the line as this driver does: the robot must know before.
  link_.flush(now);
  link_.begin_anew(now, pause, "this driver was held up, its guardian has ended the session");
}

void P3dxNode::poll() {
  const std::int64_t now = desk_.wake();
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
    desk_.gate().clear(now);  // nobody sees what the robot does
  }
  if (!link_.in_session()) {
    session_ = 0;
  } else {
    send_settings(now);
  }
  command_motion(now);
  link_.flush(now);
  publish_status(now);
  desk_.finish_poll(now);
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
  desk_.gate().clear(now);
  desk_.gate().set_limits(std::min(limits.linear, 1e-3 * robot.velocity_top),
                          std::min(limits.angular, radians(robot.turn_rate_top)));
  writer_.restart();
  link_.send(encode_command(ArcosCommand::kVelocity, 0));
  link_.send(encode_command(ArcosCommand::kTurnRate, 0));
  link_.send(encode_command(ArcosCommand::kSonar, 1));
  settings_.begin(desk_.gate().params().maximum_linear, desk_.gate().params().maximum_angular);
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
    desk_.gate().clear(now);  // whatever was asked of a robot without motors is not done later
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
  desk_.gate().clear(clock_.utime());
  link_.send(encode_command(ArcosCommand::kEmergencyStop));
  link_.send(encode_command(ArcosCommand::kEnable, 0));
}

void P3dxNode::command_motion(std::int64_t now) {
  if (!link_.in_session() || link_.waiting_frames() >= kMotionQueue || !last_.motors_enabled) {
    return;
  }
  told_ = desk_.wanted(now);
  for (std::vector<std::uint8_t>& frame : writer_.poll(told_, now)) {
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
  std::optional<robot_status_t> due = desk_.due_status(now, connected);
  if (!due) {
    return;
  }
  robot_status_t& message = *due;
  message.session = session_;
  message.connected = connected ? 1 : 0;
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
  if (connected && charge <= robot_status_t::CHARGE_BALANCE) {
    message.charge_state = static_cast<std::int8_t>(charge);
  }
  if (link_.has_configuration()) {
    message.deceleration = 1e-3 * link_.configuration().deceleration;
  }
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
  return desk_.reason(now, "", last_.stall_left, last_.stall_right);
}

Health P3dxNode::health() const {
  Health health;
  health.dropped_inputs = desk_.subscriber().dropped();
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
  } else if (!desk_.stop().trouble().empty()) {
    health.degraded = true;
    health.reason = desk_.stop().trouble();
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
  if (desk_.hold(why)) {
    writer_.restart();  // at once, however short ago the last change was
  }
}

bool P3dxNode::stand_still() {
  const bool stands = desk_.stand_for_good({reckoning_.linear(), reckoning_.angular()});
  return stands || !connected();
}

std::string P3dxNode::describe_line() const {
  return luminav::describe_line(link_, desk_.gate().params().maximum_linear, config_.robot.limits.linear_deceleration);
}

void P3dxNode::shut_down() {
  link_.close_with({encode_command(ArcosCommand::kVelocity, 0), encode_command(ArcosCommand::kTurnRate, 0),
                    encode_command(ArcosCommand::kStop), encode_command(ArcosCommand::kEnable, 0),
                    encode_command(ArcosCommand::kSonar, 0), encode_command(ArcosCommand::kClose)});
  session_ = 0;
}

}  // namespace luminav
