#include "drivers/p3dx/arcos/information_packet.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/byte_words.hpp"

namespace luminav {
namespace {

constexpr int kHighestDisc = 31;
constexpr std::size_t kFixedPart = 19;  // up to and including the sonar count
constexpr int kSaturatedBattery = 255;  // 25.5 V: the word further back has the truth
constexpr std::size_t kLongestText = 40;

std::string printable(std::string text) {
  text.resize(std::min(text.size(), kLongestText));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

void read_flags(int flags, InformationPacket& packet) {
  packet.motors_enabled = (flags & 1) != 0;
  packet.sonar_arrays = (flags >> 1) & 0xF;
  packet.stop_button = (flags & (1 << 5)) != 0;
  packet.stop_button_stall = (flags & (1 << 6)) != 0;
  packet.charger_power = (flags & (1 << 10)) != 0;
}

int flags_of(const InformationPacket& packet) {
  return (packet.motors_enabled ? 1 : 0) | ((packet.sonar_arrays & 0xF) << 1) | (packet.stop_button ? 1 << 5 : 0) |
         (packet.stop_button_stall ? 1 << 6 : 0) | (packet.charger_power ? 1 << 10 : 0);
}

void read_tail(WordReader& reader, InformationPacket& packet) {
  if (reader.left() < 5) {
    return;
  }
  packet.has_extension = true;
  reader.u8();  // gripper
  packet.analog_port = reader.u8();
  packet.analog = reader.u8();
  packet.digital_in = reader.u8();
  packet.digital_out = reader.u8();
  // From here on each field ends the packet of some firmware; half a field is none.
  if (reader.left() < 2) {
    return;
  }
  const int tenths = reader.u16();
  const int coarse = static_cast<int>(std::lround(packet.battery_voltage * 10.0));
  if (tenths != 0 && (coarse == 0 || coarse == kSaturatedBattery)) {
    packet.battery_voltage = tenths / 10.0;
  }
  if (reader.left() < 1) {
    return;
  }
  packet.charge_state = reader.u8();
  if (reader.left() < 2) {
    return;
  }
  packet.turn_rate = reader.s16();
  if (reader.left() < 2) {
    return;
  }
  packet.fault_flags = reader.u16();
  if (reader.left() < 4) {
    return;
  }
  reader.u16();  // sideways velocity
  const int temperature = reader.s8();
  if (temperature > -127) {
    packet.temperature = temperature;
  }
  packet.state_of_charge = reader.u8();
}

}  // namespace

std::optional<InformationPacket> decode_information(std::uint8_t type, std::span<const std::uint8_t> payload) {
  if (!is_information(type) || payload.size() < kFixedPart) {
    return std::nullopt;
  }
  WordReader reader(payload);
  InformationPacket packet;
  packet.moving = type == packet_type::kMoving;
  packet.x_mm = reader.s16();
  packet.y_mm = reader.s16();
  packet.heading = reader.s16();
  packet.left_mm_s = reader.s16();
  packet.right_mm_s = reader.s16();
  packet.battery_voltage = reader.u8() / 10.0;
  const int low = reader.u8();
  const int high = reader.u8();
  packet.stall_left = (low & 1) != 0;
  packet.stall_right = (high & 1) != 0;
  packet.bumpers_rear = low >> 1;
  packet.bumpers_front = high >> 1;
  packet.heading_setpoint = reader.s16();
  read_flags(reader.u16(), packet);
  packet.compass = reader.u8();
  const std::size_t count = reader.u8();
  if (count * 3 > reader.left()) {
    return std::nullopt;
  }
  packet.sonar.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int disc = reader.u8();
    const int range = reader.u16();
    if (disc > kHighestDisc) {
      return std::nullopt;
    }
    packet.sonar.push_back({disc, range});
  }
  read_tail(reader, packet);
  return packet;
}

std::vector<std::uint8_t> encode_information(const InformationPacket& packet) {
  WordWriter writer;
  writer.u16(packet.x_mm);
  writer.u16(packet.y_mm);
  writer.u16(packet.heading);
  writer.u16(packet.left_mm_s);
  writer.u16(packet.right_mm_s);
  const int tenths = static_cast<int>(std::lround(packet.battery_voltage * 10.0));
  writer.u8(std::clamp(tenths, 0, kSaturatedBattery));
  writer.u8((packet.stall_left ? 1 : 0) | (packet.bumpers_rear << 1));
  writer.u8((packet.stall_right ? 1 : 0) | (packet.bumpers_front << 1));
  writer.u16(packet.heading_setpoint);
  writer.u16(flags_of(packet));
  writer.u8(packet.compass);
  writer.u8(static_cast<int>(packet.sonar.size()));
  for (const SonarReading& reading : packet.sonar) {
    writer.u8(reading.disc);
    writer.u16(reading.range_mm);
  }
  writer.u8(0);  // gripper
  writer.u8(packet.analog_port);
  writer.u8(packet.analog);
  writer.u8(packet.digital_in);
  writer.u8(packet.digital_out);
  writer.u16(tenths);
  writer.u8(packet.charge_state.value_or(0xFF));
  writer.u16(packet.turn_rate.value_or(0));
  writer.u16(packet.fault_flags);
  writer.u16(0);  // sideways velocity
  writer.u8(packet.temperature.value_or(-127));
  writer.u8(packet.state_of_charge.value_or(0));
  return encode_packet(packet.moving ? packet_type::kMoving : packet_type::kStanding, writer.bytes());
}

RobotIdentity decode_identity(std::span<const std::uint8_t> payload) {
  WordReader reader(payload);
  RobotIdentity identity;
  identity.name = printable(reader.text());
  identity.robot_class = printable(reader.text());
  identity.subclass = printable(reader.text());
  return identity;
}

std::vector<std::uint8_t> encode_identity(const RobotIdentity& identity) {
  WordWriter writer;
  writer.text(identity.name);
  writer.text(identity.robot_class);
  writer.text(identity.subclass);
  return encode_packet(packet_type::kSync2, writer.bytes());
}

std::optional<EncoderPacket> decode_encoder(std::span<const std::uint8_t> payload) {
  WordReader reader(payload);
  EncoderPacket packet;
  packet.left = reader.s32();
  packet.right = reader.s32();
  return reader.complete() ? std::optional(packet) : std::nullopt;
}

std::vector<std::uint8_t> encode_encoder(const EncoderPacket& packet) {
  WordWriter writer;
  writer.u32(static_cast<std::uint32_t>(packet.left));
  writer.u32(static_cast<std::uint32_t>(packet.right));
  return encode_packet(packet_type::kEncoder, writer.bytes());
}

std::optional<InputOutputPacket> decode_input_output(std::span<const std::uint8_t> payload) {
  WordReader reader(payload);
  InputOutputPacket packet;
  packet.digital_in.resize(std::min<std::size_t>(reader.u8(), reader.left()));
  for (int& value : packet.digital_in) {
    value = reader.u8();
  }
  packet.digital_out.resize(std::min<std::size_t>(reader.u8(), reader.left()));
  for (int& value : packet.digital_out) {
    value = reader.u8();
  }
  // The manual's own table announces more analog words than it lists: what is there counts.
  packet.analog.resize(std::min<std::size_t>(reader.u8(), reader.left() / 2));
  for (int& value : packet.analog) {
    value = reader.u16();
  }
  return reader.complete() ? std::optional(packet) : std::nullopt;
}

std::vector<std::uint8_t> encode_input_output(const InputOutputPacket& packet) {
  WordWriter writer;
  writer.u8(static_cast<int>(packet.digital_in.size()));
  for (const int value : packet.digital_in) {
    writer.u8(value);
  }
  writer.u8(static_cast<int>(packet.digital_out.size()));
  for (const int value : packet.digital_out) {
    writer.u8(value);
  }
  writer.u8(static_cast<int>(packet.analog.size()));
  for (const int value : packet.analog) {
    writer.u16(value);
  }
  return encode_packet(packet_type::kInputOutput, writer.bytes());
}

}  // namespace luminav
