#include "drivers/simulator/arcos/arcos_controller.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/simulator/arcos/battery.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr double kHeadingUnits = 4096.0 / (2.0 * kPi);  // per radian
constexpr double kSpeedTime = 0.03;                     // [s] over which the wheel speeds are averaged
constexpr double kMovingSpeed = 0.005;                  // [m/s] of a wheel: the packet says "moving"
constexpr std::int64_t kPacketPause = 50'000;           // [us] a client sends a packet in one go
constexpr std::size_t kLongestOutput = 65536;           // [bytes] nobody reads: the oldest are lost

std::int16_t wrapped(double value) {
  return static_cast<std::int16_t>(std::llround(value) & 0xFFFF);
}

}  // namespace

ArcosController::ArcosController(const ArcosConfig& config)
    : config_(config),
      motion_(config.flash),
      sonar_(config.flash, config.mobilesim),
      baud_code_(config.flash.host_baud) {}

void ArcosController::receive(std::span<const std::uint8_t> bytes) {
  parser_.push(bytes);
  line_pause_ = bytes.empty() ? line_pause_ : 0;
  obey_packets();
}

void ArcosController::obey_packets() {
  while (const auto packet = parser_.next()) {
    silence_ = 0;
    if (session_open_) {
      execute(static_cast<ArcosCommand>(packet->type), decode_argument(packet->payload), packet->payload);
    } else {
      on_sync(packet->type);
    }
  }
}

void ArcosController::on_sync(std::uint8_t command) {
  const bool opens = command == static_cast<std::uint8_t>(ArcosCommand::kOpen) && sync_count_ == 3;
  if (opens) {
    open_session();
    return;
  }
  if (command > packet_type::kSync2) {
    return;
  }
  // ARCOS answers a SYNC out of order by waiting for SYNC0 again; a repeated one is answered again.
  const bool in_order = command == 0 || command == sync_count_ || command + 1 == sync_count_;
  if (!in_order && !config_.mobilesim) {
    sync_count_ = 0;
    return;
  }
  sync_count_ = command + 1;
  if (command == packet_type::kSync2) {
    send(encode_identity({config_.flash.name, config_.flash.robot_class, config_.flash.subclass}));
  } else {
    send(encode_packet(command));
  }
}

void ArcosController::open_session() {
  session_open_ = true;
  motors_enabled_ = false;
  motion_ = ArcosMotion(config_.flash);
  sonar_ = ArcosSonar(config_.flash, config_.mobilesim);
  encoder_stream_ = 0;
  io_stream_ = 0;
  until_information_ = 1000 * config_.flash.information_cycle;
  if (config_.mobilesim) {
    motors_enabled_ = true;
  }
}

void ArcosController::close_session() {
  session_open_ = false;
  sync_count_ = 0;
  enable_motors(false);
  baud_code_ = config_.flash.host_baud;  // ARIA lowers its own side after CLOSE and relies on it
}

void ArcosController::on_line_closed() {
  if (config_.mobilesim) {
    close_session();
  }
}

void ArcosController::execute(ArcosCommand command, const CommandArgument& argument,
                              std::span<const std::uint8_t> payload) {
  const int value = argument.value;
  switch (command) {
    case ArcosCommand::kClose:
      close_session();
      break;
    case ArcosCommand::kPolling:
      // Some clients send a text that ends in NUL and has no length: 0 is no disc, so both are understood.
      sonar_.set_polling(argument.text);
      break;
    case ArcosCommand::kEnable:
      enable_motors(value != 0);
      break;
    case ArcosCommand::kSetAcceleration:
      motion_.set_acceleration(value);
      break;
    case ArcosCommand::kSetMaximumVelocity:
      motion_.set_maximum_velocity(value);
      break;
    case ArcosCommand::kSetMaximumTurnRate:
      motion_.set_maximum_turn_rate(value);
      break;
    case ArcosCommand::kSetTurnAcceleration:
      motion_.set_turn_acceleration(value);
      break;
    case ArcosCommand::kSetOrigin:
      x_ = y_ = theta_ = 0.0;
      break;
    case ArcosCommand::kConfiguration:
      send(encode_configuration(configuration()));
      break;
    case ArcosCommand::kSonar:
      sonar_.switch_arrays(value);
      break;
    case ArcosCommand::kSonarCycle:
      sonar_.set_cycle(value);
      break;
    case ArcosCommand::kStop:
      motion_.stop();
      break;
    case ArcosCommand::kEmergencyStop:
      motion_.emergency_stop();
      break;
    case ArcosCommand::kStopButtonStall:
      stop_button_stall_ = value != 0;
      break;
    case ArcosCommand::kBumpStall:
      bump_stall_ = std::clamp(value, 0, 3);
      break;
    case ArcosCommand::kDigitalOut:
      // The mask is the second byte of the argument, whatever sign byte precedes it.
      if (payload.size() >= 3) {
        digital_out_ = (digital_out_ & ~payload[2]) | (payload[1] & payload[2]);
      }
      break;
    case ArcosCommand::kEncoder:
      encoder_stream_ = config_.mobilesim ? 0 : std::clamp(value, 0, 2);
      break;
    case ArcosCommand::kIoRequest:
      io_stream_ = config_.mobilesim ? 0 : std::clamp(value, 0, 2);
      break;
    case ArcosCommand::kAnalogSelect:
      analog_port_ = value & 7;
      break;
    case ArcosCommand::kHostBaud:
      if (baud_of_code(value) != 0) {
        baud_code_ = value;
      }
      break;
    case ArcosCommand::kBatteryTest:
      fake_battery_ = value > 0 ? std::optional(value / 10.0) : std::nullopt;
      break;
    case ArcosCommand::kReset:
      close_session();
      x_ = y_ = theta_ = 0.0;
      break;
    default:
      execute_motion(command, value);
  }
}

void ArcosController::execute_motion(ArcosCommand command, int value) {
  if (!motors_enabled_) {
    return;  // a setpoint must not wait for the motors to come on
  }
  switch (command) {
    case ArcosCommand::kVelocity:
      motion_.set_velocity(value);
      break;
    case ArcosCommand::kTurnRate:
    case ArcosCommand::kRotate:
      motion_.set_turn_rate(value);
      break;
    case ArcosCommand::kHeading:
      motion_.turn_to(value);
      break;
    case ArcosCommand::kTurnBy:
      motion_.turn_by(value, theta_);
      break;
    case ArcosCommand::kTurnFromSetpoint:
      motion_.turn_from_setpoint(value, theta_);
      break;
    case ArcosCommand::kMove:
      motion_.move_by(value);
      break;
    case ArcosCommand::kWheelVelocities: {
      constexpr int kUnit = 20;  // [mm/s]
      const WheelVelocities wheels = decode_wheel_velocities(value);
      motion_.set_wheels(kUnit * wheels.left, kUnit * wheels.right, config_.wheel_base);
      break;
    }
    default:
      break;  // unknown commands come from every client
  }
}

void ArcosController::enable_motors(bool enable) {
  if (enable && sensed_.stop_button) {
    return;
  }
  if (!enable || !motors_enabled_) {
    motion_.emergency_stop();
  }
  motors_enabled_ = enable;
}

void ArcosController::sense(double dt, const ArcosInputs& inputs) {
  const double travel = 0.5 * (inputs.left_travel + inputs.right_travel);
  const double turn = (inputs.right_travel - inputs.left_travel) / config_.wheel_base;
  x_ += travel * std::cos(theta_ + 0.5 * turn);
  y_ += travel * std::sin(theta_ + 0.5 * turn);
  theta_ += turn;
  left_total_ += inputs.left_travel;
  right_total_ += inputs.right_travel;
  const double share = std::min(1.0, dt / kSpeedTime);
  left_speed_ += share * (inputs.left_travel / dt - left_speed_);
  right_speed_ += share * (inputs.right_travel / dt - right_speed_);
  const bool motors_pressed = inputs.motors_button && !sensed_.motors_button;
  sensed_ = inputs;
  if (motors_pressed && session_open_) {
    enable_motors(!motors_enabled_);
  }
  if (inputs.stop_button && stop_button_stall_ && motors_enabled_) {
    enable_motors(false);
  }
  const bool bumped = (inputs.bumpers_front != 0 && (bump_stall_ & 1) != 0 && motion_.linear() > 0.0) ||
                      (inputs.bumpers_rear != 0 && (bump_stall_ & 2) != 0 && motion_.linear() < 0.0);
  if (inputs.stall_left || inputs.stall_right || bumped) {
    stall_rest_ = 1000 * config_.flash.stall_count;
  }
}

ArcosOutputs ArcosController::step(double dt, const ArcosInputs& inputs) {
  if (dt <= 0.0) {
    return {motion_.linear(), motion_.angular(), motors_enabled_, {}};
  }
  const auto microseconds = static_cast<std::int64_t>(std::llround(dt * 1e6));
  sense(dt, inputs);
  silence_ += microseconds;
  line_pause_ += microseconds;
  if (parser_.has_partial() && line_pause_ > kPacketPause) {
    parser_.give_up_partial();  // a damaged count would swallow all that a hesitant client says next
    obey_packets();
  }
  const std::int64_t watchdog = config_.mobilesim ? 0 : 1000LL * config_.flash.watchdog;
  motion_.set_halted(!motors_enabled_ || stall_rest_ > 0 || (watchdog > 0 && silence_ > watchdog));
  if (stall_rest_ > 0) {
    stall_rest_ -= microseconds;
    motion_.freeze();
  }
  motion_.step(dt, theta_, 0.5 * (left_total_ + right_total_));
  ArcosOutputs outputs{motion_.linear(), motion_.angular(), motors_enabled_, {}};
  if (session_open_) {
    outputs.sonar_discs = sonar_.step(microseconds);
    until_information_ -= microseconds;
    if (until_information_ <= 0) {
      until_information_ += 1000 * std::max(config_.flash.information_cycle, 10);
      send_information();
    }
  }
  return outputs;
}

void ArcosController::set_sonar_reading(int disc, double range) {
  if (disc >= 0 && disc < 16) {
    sonar_.set_reading(disc, range);
  }
}

std::vector<std::uint8_t> ArcosController::take_output() {
  std::vector<std::uint8_t> taken;
  taken.swap(output_);
  return taken;
}

int ArcosController::baud() const {
  return baud_of_code(baud_code_);
}

void ArcosController::send(std::vector<std::uint8_t> frame) {
  if (output_.size() > kLongestOutput) {
    output_.clear();
  }
  output_.insert(output_.end(), frame.begin(), frame.end());
}

void ArcosController::send_information() {
  send(encode_information(information()));
  if (encoder_stream_ > 0) {
    const double ticks = 1000.0 * config_.flash.ticks_per_mm;
    send(encode_encoder({static_cast<std::int32_t>(std::llround(left_total_ * ticks)),
                         static_cast<std::int32_t>(std::llround(right_total_ * ticks))}));
    encoder_stream_ = encoder_stream_ == 1 ? 0 : encoder_stream_;
  }
  if (io_stream_ > 0) {
    const int battery = static_cast<int>(std::lround(sensed_.battery_voltage / 20.0 * 1023.0));
    // Inputs idle high; bumper bits are raw.
    send(encode_input_output({{0xFF, sensed_.bumpers_front ^ 0xFF, sensed_.bumpers_rear ^ 0xFF, 0xFF},
                              {digital_out_},
                              {0, 0, 0, 0, std::clamp(battery, 0, 1023)}}));
    io_stream_ = io_stream_ == 1 ? 0 : io_stream_;
  }
}

ConfigurationPacket ArcosController::configuration() const {
  ConfigurationPacket packet = config_.flash;
  motion_.write_limits(packet);
  packet.host_baud = baud_code_;
  if (config_.mobilesim) {
    packet.watchdog = 2000;
    packet.firmware = "S.0";
  }
  return packet;
}

InformationPacket ArcosController::information() {
  InformationPacket packet;
  const double heading = config_.mobilesim ? radians(std::round(degrees(theta_))) : theta_;
  packet.x_mm = wrapped(1000.0 * x_);
  packet.y_mm = wrapped(1000.0 * y_);
  packet.heading = wrapped(std::remainder(heading * kHeadingUnits, 4096.0));
  packet.left_mm_s = wrapped(1000.0 * left_speed_);
  packet.right_mm_s = wrapped(1000.0 * right_speed_);
  packet.moving = !config_.mobilesim && std::max(std::abs(left_speed_), std::abs(right_speed_)) > kMovingSpeed;
  packet.battery_voltage = fake_battery_.value_or(sensed_.battery_voltage);
  packet.stall_left = sensed_.stall_left;
  packet.stall_right = sensed_.stall_right;
  packet.bumpers_front = sensed_.bumpers_front & 0x7F;
  packet.bumpers_rear = sensed_.bumpers_rear & 0x7F;
  packet.heading_setpoint = wrapped(std::remainder(motion_.heading_setpoint(theta_) * kHeadingUnits, 4096.0));
  packet.motors_enabled = motors_enabled_;
  packet.sonar_arrays = config_.mobilesim ? 0xF : sonar_.arrays_on();
  packet.stop_button = sensed_.stop_button;
  packet.stop_button_stall = sensed_.stop_button && stop_button_stall_;
  packet.sonar = sonar_.take_readings();
  packet.digital_in = 0xFF;
  packet.digital_out = digital_out_;
  packet.analog_port = analog_port_;
  packet.charge_state = sensed_.charge_state;
  packet.charger_power = sensed_.charge_state > 0;
  packet.turn_rate = static_cast<int>(std::lround(10.0 * degrees((right_speed_ - left_speed_) / config_.wheel_base)));
  packet.state_of_charge = static_cast<int>(std::lround(
      100.0 * std::clamp((sensed_.battery_voltage - Battery::kEmpty) / (Battery::kFull - Battery::kEmpty), 0.0, 1.0)));
  return packet;
}

}  // namespace luminav
