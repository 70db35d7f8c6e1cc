#include "drivers/simulator/arcos/arcos_controller.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/simulator/arcos/battery.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kPacketPause = 50'000;  // [us] a client sends a packet in one go
constexpr std::size_t kLongestOutput = 65536;  // [bytes] nobody reads: the oldest are lost

}  // namespace

ArcosController::ArcosController(const ArcosConfig& config)
    : config_(config),
      motion_(config.flash),
      sonar_(config.flash, config.mobilesim),
      odometry_(config.wheel_base),
      stalls_(1000 * config.flash.stall_count),
      schedule_(config.flash.information_cycle),
      baud_code_(config.flash.host_baud) {}

void ArcosController::receive(std::span<const std::uint8_t> bytes) {
  parser_.push(bytes, now_);
  obey_packets();
}

void ArcosController::obey_packets() {
  while (const auto packet = parser_.next()) {
    last_packet_ = now_;
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
  motors_enabled_ = config_.mobilesim;
  motion_ = ArcosMotion(config_.flash);
  sonar_ = ArcosSonar(config_.flash, config_.mobilesim);
  schedule_ = PacketSchedule(config_.flash.information_cycle);
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
    case ArcosCommand::kSetOrigin:
      odometry_.set_origin();
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
    case ArcosCommand::kDigitalOut:
      // The mask is the second byte of the argument, whatever sign byte precedes it.
      if (payload.size() >= 3) {
        digital_out_ = (digital_out_ & ~payload[2]) | (payload[1] & payload[2]);
      }
      break;
    case ArcosCommand::kEncoder:
      schedule_.request(PacketSchedule::kEncoders, config_.mobilesim ? 0 : value);
      break;
    case ArcosCommand::kIoRequest:
      schedule_.request(PacketSchedule::kInputOutput, config_.mobilesim ? 0 : value);
      break;
    case ArcosCommand::kReset:
      close_session();
      odometry_.set_origin();
      break;
    default:
      execute_setting(command, value);
  }
}

void ArcosController::execute_setting(ArcosCommand command, int value) {
  switch (command) {
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
    case ArcosCommand::kStopButtonStall:
      stalls_.set_stop_button(value != 0);
      break;
    case ArcosCommand::kBumpStall:
      stalls_.set_bumpers(std::clamp(value, 0, 3));
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
      motion_.turn_by(value, odometry_.theta());
      break;
    case ArcosCommand::kTurnFromSetpoint:
      motion_.turn_from_setpoint(value, odometry_.theta());
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
  odometry_.add(dt, inputs.left_travel, inputs.right_travel);
  const bool motors_pressed = inputs.motors_button && !sensed_.motors_button;
  sensed_ = inputs;
  if (motors_pressed && session_open_) {
    enable_motors(!motors_enabled_);
  }
  if (stalls_.is_stopped(inputs) && motors_enabled_) {
    enable_motors(false);
  }
  stalls_.sense(inputs, motion_.linear());
}

ArcosOutputs ArcosController::step(double dt, const ArcosInputs& inputs) {
  if (dt <= 0.0) {
    return {motion_.linear(), motion_.angular(), motors_enabled_, {}};
  }
  const auto microseconds = static_cast<std::int64_t>(std::llround(dt * 1e6));
  sense(dt, inputs);
  now_ += microseconds;
  if (parser_.has_partial() && now_ - parser_.last_arrival() > kPacketPause) {
    parser_.give_up_partial();  // a damaged count would swallow all that a hesitant client says next
    obey_packets();
  }
  const std::int64_t watchdog = config_.mobilesim ? 0 : 1000LL * config_.flash.watchdog;
  motion_.set_halted(!motors_enabled_ || stalls_.is_resting() || (watchdog > 0 && now_ - last_packet_ > watchdog));
  if (stalls_.is_resting()) {
    stalls_.step(microseconds);
    motion_.freeze();
  }
  motion_.step(dt, odometry_.theta(), odometry_.distance());
  ArcosOutputs outputs{motion_.linear(), motion_.angular(), motors_enabled_, {}};
  if (session_open_) {
    outputs.sonar_discs = sonar_.step(microseconds);
    if (schedule_.step(microseconds)) {
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
  if (schedule_.take(PacketSchedule::kEncoders)) {
    send(encode_encoder(odometry_.encoders(1000.0 * config_.flash.ticks_per_mm)));
  }
  if (schedule_.take(PacketSchedule::kInputOutput)) {
    const int battery = static_cast<int>(std::lround(sensed_.battery_voltage / 20.0 * 1023.0));
    // Inputs idle high; bumper bits are raw.
    send(encode_input_output({{0xFF, sensed_.bumpers_front ^ 0xFF, sensed_.bumpers_rear ^ 0xFF, 0xFF},
                              {digital_out_},
                              {0, 0, 0, 0, std::clamp(battery, 0, 1023)}}));
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
  odometry_.write_to(packet);
  if (config_.mobilesim) {
    packet.heading = ArcosOdometry::heading_units(radians(std::round(degrees(odometry_.theta()))));
    packet.moving = false;
  }
  packet.battery_voltage = fake_battery_.value_or(sensed_.battery_voltage);
  packet.stall_left = sensed_.stall_left;
  packet.stall_right = sensed_.stall_right;
  packet.bumpers_front = sensed_.bumpers_front & 0x7F;
  packet.bumpers_rear = sensed_.bumpers_rear & 0x7F;
  packet.heading_setpoint = ArcosOdometry::heading_units(motion_.heading_setpoint(odometry_.theta()));
  packet.motors_enabled = motors_enabled_;
  packet.sonar_arrays = config_.mobilesim ? 0xF : sonar_.arrays_on();
  packet.stop_button = sensed_.stop_button;
  packet.stop_button_stall = stalls_.is_stopped(sensed_);
  packet.sonar = sonar_.take_readings();
  packet.digital_in = 0xFF;
  packet.digital_out = digital_out_;
  packet.analog_port = analog_port_;
  packet.charge_state = sensed_.charge_state;
  packet.charger_power = sensed_.charge_state > 0;
  packet.state_of_charge = static_cast<int>(std::lround(
      100.0 * std::clamp((sensed_.battery_voltage - Battery::kEmpty) / (Battery::kFull - Battery::kEmpty), 0.0, 1.0)));
  return packet;
}

}  // namespace luminav
