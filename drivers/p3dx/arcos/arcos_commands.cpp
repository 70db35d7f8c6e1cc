#include "drivers/p3dx/arcos/arcos_commands.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace luminav {
namespace {

constexpr std::uint8_t kPositive = 0x3B;
constexpr std::uint8_t kNegative = 0x1B;
constexpr std::uint8_t kText = 0x2B;
constexpr int kLargestMagnitude = 32767;
constexpr std::size_t kLongestText = 199;
constexpr std::array<int, 5> kBauds = {9600, 19200, 38400, 57600, 115200};

}  // namespace

std::vector<std::uint8_t> encode_command(ArcosCommand command) {
  return encode_packet(static_cast<std::uint8_t>(command));
}

std::vector<std::uint8_t> encode_command(ArcosCommand command, int value) {
  const int clamped = std::clamp(value, -kLargestMagnitude, kLargestMagnitude);
  const int magnitude = std::abs(clamped);
  const std::array<std::uint8_t, 3> payload = {clamped < 0 ? kNegative : kPositive,
                                               static_cast<std::uint8_t>(magnitude & 0xFF),
                                               static_cast<std::uint8_t>(magnitude >> 8)};
  return encode_packet(static_cast<std::uint8_t>(command), payload);
}

std::vector<std::uint8_t> encode_command(ArcosCommand command, std::string_view text) {
  text = text.substr(0, kLongestText);
  std::vector<std::uint8_t> payload = {kText, static_cast<std::uint8_t>(text.size())};
  payload.insert(payload.end(), text.begin(), text.end());
  return encode_packet(static_cast<std::uint8_t>(command), payload);
}

CommandArgument decode_argument(std::span<const std::uint8_t> payload) {
  CommandArgument argument;
  if (payload.empty()) {
    return argument;
  }
  const std::uint8_t type = payload[0];
  payload = payload.subspan(1);
  if ((type == kPositive || type == kNegative) && payload.size() >= 2) {
    const int magnitude = payload[0] | (payload[1] << 8);
    // A word above 32767 is a two's complement from a client that did not take the magnitude.
    const int word = magnitude > kLargestMagnitude && type == kPositive ? magnitude - 65536 : magnitude;
    argument.kind = CommandArgument::Kind::kInteger;
    argument.value = type == kNegative ? -word : word;
  } else if (type == kText) {
    argument.kind = CommandArgument::Kind::kText;
    const bool has_length = !payload.empty() && static_cast<std::size_t>(payload[0]) + 1 <= payload.size();
    argument.text = has_length ? payload.subspan(1, payload[0]) : payload;
  }
  return argument;
}

std::vector<std::uint8_t> encode_wheel_velocities(const WheelVelocities& wheels) {
  const int left = std::clamp(wheels.left, -127, 127);
  const int right = std::clamp(wheels.right, -127, 127);
  const std::array<std::uint8_t, 3> payload = {kPositive, static_cast<std::uint8_t>(right & 0xFF),
                                               static_cast<std::uint8_t>(left & 0xFF)};
  return encode_packet(static_cast<std::uint8_t>(ArcosCommand::kWheelVelocities), payload);
}

WheelVelocities decode_wheel_velocities(int word) {
  const auto bits = static_cast<std::uint16_t>(word & 0xFFFF);
  return {static_cast<std::int8_t>(bits >> 8), static_cast<std::int8_t>(bits & 0xFF)};
}

int baud_of_code(int code) {
  return code >= 0 && code < static_cast<int>(kBauds.size()) ? kBauds[static_cast<std::size_t>(code)] : 0;
}

int code_of_baud(int baud) {
  const auto found = std::find(kBauds.begin(), kBauds.end(), baud);
  return found == kBauds.end() ? -1 : static_cast<int>(found - kBauds.begin());
}

}  // namespace luminav
