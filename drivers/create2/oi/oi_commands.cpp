#include "drivers/create2/oi/oi_commands.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

void push_word(std::vector<std::uint8_t>& bytes, int value) {
  const auto word = static_cast<std::uint16_t>(static_cast<std::int16_t>(value));
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word & 0xFF));
}

}  // namespace

bool leads_over_an_edge(double linear, double angular) {
  constexpr double kRadius = 0.17;  // [m] of the robot
  return linear > 0.0 || std::abs(linear) < kRadius * std::abs(angular);
}

int oi_data_size(std::uint8_t opcode) {
  switch (static_cast<OiOpcode>(opcode)) {
    case OiOpcode::kDriveDirect:
      return 4;
    case OiOpcode::kStream:
    case OiOpcode::kPauseStream:
      return 1;
    case OiOpcode::kStart:
    case OiOpcode::kSafe:
    case OiOpcode::kFull:
      break;
  }
  return 0;
}

std::vector<std::uint8_t> encode_opcode(OiOpcode opcode) {
  return {static_cast<std::uint8_t>(opcode)};
}

std::vector<std::uint8_t> encode_drive_direct(int left_mm_s, int right_mm_s) {
  std::vector<std::uint8_t> bytes = encode_opcode(OiOpcode::kDriveDirect);
  push_word(bytes, std::clamp(right_mm_s, -kOiMaxWheelSpeed, kOiMaxWheelSpeed));  // the right wheel comes first
  push_word(bytes, std::clamp(left_mm_s, -kOiMaxWheelSpeed, kOiMaxWheelSpeed));
  return bytes;
}

std::vector<std::uint8_t> encode_stream_request(std::span<const std::uint8_t> ids) {
  std::vector<std::uint8_t> bytes(2 + ids.size());
  bytes[0] = static_cast<std::uint8_t>(OiOpcode::kStream);
  bytes[1] = static_cast<std::uint8_t>(ids.size());
  std::copy(ids.begin(), ids.end(), bytes.begin() + 2);
  return bytes;
}

std::vector<std::uint8_t> encode_halt() {
  constexpr std::size_t kFill = 4;  // zeros: data of a command that was cut
  const std::vector<std::uint8_t> stand = encode_drive_direct(0, 0);
  std::vector<std::uint8_t> bytes(kFill + stand.size());
  std::copy(stand.begin(), stand.end(), bytes.begin() + kFill);
  return bytes;
}

}  // namespace luminav
