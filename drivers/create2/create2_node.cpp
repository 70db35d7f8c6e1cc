#include "drivers/create2/create2_node.hpp"

#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kOdometryPeriod = 100'000;  // [us] 10 Hz of the 67 Hz that the robot sends

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
      link_(std::move(open_stream)),
      odometry_({.wheel_base = config.robot.wheel_base}),
      writer_(config.robot.limits, config.robot.wheel_base),
      power_(config.enable_motors_at_start),
      desk_(lcm, config, clock, key, *this) {}

void Create2Node::switch_motors(std::int64_t now, bool enable) {
  power_.request(enable);
  if (link_.connected()) {
    link_.send(writer_.halt(now));
  }
}

void Create2Node::stand_after_gap(std::int64_t now) {
  link_.drop_waiting();
  if (link_.connected()) {
    link_.send(writer_.halt(now));
    link_.flush();
  }
}

void Create2Node::begin_anew(std::int64_t now, std::int64_t pause) {
  link_.begin_anew(now, pause, "this driver was held up, its guardian has stopped the robot");
}

void Create2Node::poll() {
  const std::int64_t now = desk_.wake();
  const Create2Events events = link_.poll(now);
  impossible_readings_ += events.undecodable;
  if (events.connected) {
    session_ = 0;  // the wheels may have turned unseen
    power_.on_connected();
    writer_.restart();
    desk_.gate().clear(now);
  }
  for (const TimedReading& received : events.readings) {
    on_reading(received, now);
  }
  if (!link_.connected()) {
    session_ = 0;
    desk_.gate().clear(now);  // nobody sees what the robot does
  }
  command_motion(now);
  publish_status(now);
  desk_.finish_poll(now);
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
    desk_.gate().clear(now);  // a command from before knows nothing of it
    link_.send(writer_.halt(now));
  }
  if (const auto mode = power_.update(last_, hazards_, now)) {
    link_.send(writer_.halt(now));
    link_.send(encode_opcode(*mode));
  }
  if (!PowerSupervisor::has_motors(last_)) {
    writer_.restart();
    if (!hazards_.sees_cliff()) {
      desk_.gate().clear(now);  // whatever was asked of a robot without motors is not done later
    }
  }
  if (received.utime >= next_odometry_) {
    const bool is_long_past = received.utime - next_odometry_ > 5 * kOdometryPeriod;
    next_odometry_ = (is_long_past ? received.utime : next_odometry_) + kOdometryPeriod;
    publish_odometry(received.utime);
  }
}

void Create2Node::command_motion(std::int64_t now) {
  if (!has_motors() || !link_.is_idle()) {
    link_.flush();
    return;
  }
  const DriveVelocity wanted = desk_.wanted(now);
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
  std::optional<robot_status_t> due = desk_.due_status(now, has_motors());
  if (!due) {
    return;
  }
  robot_status_t& message = *due;
  message.session = session_;
  message.connected = connected() ? 1 : 0;
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
  return desk_.reason(now, hazards_.reason(), last_.overcurrent_left, last_.overcurrent_right);
}

Health Create2Node::health() const {
  constexpr double kLowVoltage = 12.5;  // [V] of a battery of 14.4 V; it switches itself off at about 12
  Health health;
  health.dropped_inputs = desk_.subscriber().dropped();
  if (!connected()) {
    health.fault = true;
    health.reason = link_.trouble();
    return health;
  }
  const bool is_low = last_.voltage > 0.0 && last_.voltage < kLowVoltage;
  health.reason = !power_.reason().empty()          ? power_.reason()
                  : !desk_.stop().trouble().empty() ? desk_.stop().trouble()
                  : is_low                          ? "the battery is low"
                                                    : "";
  health.degraded = !health.reason.empty();
  return health;
}

bool Create2Node::stand_still() {
  const bool stands = desk_.stand_for_good({odometry_.linear(), odometry_.angular()});
  return stands || !connected();
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
