#include "drivers/simulator/create2/create2_board.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/create2/oi/oi_commands.hpp"
#include "drivers/create2/oi/stream_parser.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr double kCountsPerMetre = 508.8 / (kPi * 0.072);
constexpr std::int64_t kCycle = 15'000;         // [us]
constexpr std::size_t kLongestOutput = 65536;   // [bytes] nobody reads: they are lost
constexpr double kBatteryFactor = 14.4 / 12.0;  // the simulated battery has 12 V, this one 14.4 V

int word(std::uint8_t high, std::uint8_t low) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>((high << 8) | low));
}

std::uint16_t wrapped(double counts) {
  return static_cast<std::uint16_t>(std::llround(counts) & 0xFFFF);
}

}  // namespace

void Create2Board::receive(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    command_.push_back(byte);
    obey();
  }
}

void Create2Board::obey() {
  const auto opcode = static_cast<OiOpcode>(command_[0]);
  auto size = static_cast<std::size_t>(1 + oi_data_size(command_[0]));
  if (opcode == OiOpcode::kStream && command_.size() > 1) {
    size += command_[1];
  }
  if (command_.size() < size) {
    return;
  }
  switch (opcode) {
    case OiOpcode::kStart:
      mode_ = OiMode::kPassive;
      stand();
      break;
    case OiOpcode::kSafe:
    case OiOpcode::kFull:
      if (mode_ != OiMode::kOff) {
        mode_ = opcode == OiOpcode::kSafe ? OiMode::kSafe : OiMode::kFull;
      }
      break;
    case OiOpcode::kDriveDirect:
      if (is_powered()) {
        right_mm_s_ = std::clamp(word(command_[1], command_[2]), -kOiMaxWheelSpeed, kOiMaxWheelSpeed);
        left_mm_s_ = std::clamp(word(command_[3], command_[4]), -kOiMaxWheelSpeed, kOiMaxWheelSpeed);
      }
      break;
    case OiOpcode::kStream:
      streams_ = mode_ != OiMode::kOff;
      stream_.assign(command_.begin() + 2, command_.end());
      break;
    case OiOpcode::kPauseStream:
      streams_ = command_[1] != 0 && !stream_.empty();
      break;
  }
  command_.clear();
}

void Create2Board::stand() {
  left_mm_s_ = right_mm_s_ = 0;
}

BoardOutputs Create2Board::step(double dt, const BoardInputs& inputs) {
  left_counts_ += kCountsPerMetre * inputs.left_travel;
  right_counts_ += kCountsPerMetre * inputs.right_travel;
  until_cycle_ -= static_cast<std::int64_t>(std::llround(dt * 1e6));
  if (until_cycle_ <= 0) {
    until_cycle_ += kCycle;
    run_cycle(inputs);
  }
  return {linear(), angular(), is_powered(), {}};
}

void Create2Board::run_cycle(const BoardInputs& inputs) {
  const bool is_lifted = inputs.wheel_drop_left || inputs.wheel_drop_right;
  const bool is_at_edge = inputs.cliffs != 0 && leads_over_an_edge(linear(), angular());
  if (mode_ == OiMode::kSafe && (is_lifted || is_at_edge)) {
    mode_ = OiMode::kPassive;
    stand();
  }
  if (!streams_ || output_.size() >= kLongestOutput) {
    return;
  }
  SensorReading reading;
  reading.bump_left = (inputs.bumpers_front & 1) != 0;
  reading.bump_right = (inputs.bumpers_front & 2) != 0;
  reading.wheel_drop_left = inputs.wheel_drop_left;
  reading.wheel_drop_right = inputs.wheel_drop_right;
  reading.cliff_left = (inputs.cliffs & 1) != 0;
  reading.cliff_front_left = (inputs.cliffs & 2) != 0;
  reading.cliff_front_right = (inputs.cliffs & 4) != 0;
  reading.cliff_right = (inputs.cliffs & 8) != 0;
  reading.overcurrent_left = inputs.stall_left;
  reading.overcurrent_right = inputs.stall_right;
  reading.voltage = kBatteryFactor * inputs.battery_voltage;
  reading.mode = mode_;
  reading.left_count = wrapped(left_counts_);
  reading.right_count = wrapped(right_counts_);
  const std::vector<std::uint8_t> frame = encode_stream_frame(encode_readings(reading, stream_));
  output_.insert(output_.end(), frame.begin(), frame.end());
}

std::vector<std::uint8_t> Create2Board::take_output() {
  std::vector<std::uint8_t> taken;
  taken.swap(output_);
  return taken;
}

}  // namespace luminav
