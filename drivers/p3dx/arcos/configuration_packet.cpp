#include "drivers/p3dx/arcos/configuration_packet.hpp"

#include <algorithm>

#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/byte_words.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

namespace luminav {
namespace {

/// Visits all fields in the order of the wire: one list serves both directions.
template <typename Packet, typename Visitor>
void visit(Packet& p, Visitor& v) {
  v.text(p.robot_class), v.text(p.subclass), v.text(p.serial);
  v.byte(p.four_motors);
  v.word(p.turn_rate_top), v.word(p.velocity_top), v.word(p.turn_acceleration_top), v.word(p.acceleration_top);
  v.word(p.pwm_maximum);
  v.text(p.name);
  v.byte(p.information_cycle), v.byte(p.host_baud), v.byte(p.aux1_baud);
  v.word(p.has_gripper), v.word(p.has_front_sonar), v.byte(p.has_rear_sonar);
  v.word(p.low_battery), v.word(p.rev_count), v.word(p.watchdog);
  v.byte(p.p2mpacs);
  v.word(p.stall_value), v.word(p.stall_count);
  v.word(p.joystick_velocity), v.word(p.joystick_turn_rate);
  v.word(p.turn_rate_maximum), v.word(p.velocity_maximum), v.word(p.turn_acceleration), v.word(p.turn_deceleration);
  v.word(p.turn_kp), v.word(p.turn_kv), v.word(p.turn_ki);
  v.word(p.acceleration), v.word(p.deceleration);
  v.word(p.kp), v.word(p.kv), v.word(p.ki);
  v.byte(p.front_bumpers), v.byte(p.rear_bumpers), v.byte(p.charger), v.byte(p.sonar_cycle), v.byte(p.auto_baud);
  v.byte(p.has_gyro);
  v.signed_word(p.drift_factor);
  v.byte(p.aux2_baud), v.byte(p.aux3_baud);
  v.word(p.ticks_per_mm), v.word(p.shutdown_voltage);
  v.text(p.firmware);
  v.word(p.gyro_clockwise), v.word(p.gyro_counter_clockwise);
  v.byte(p.kinematics_delay);
}

/// A field is written only when all of it was in the packet.
struct Decoder {
  WordReader reader;

  void text(std::string& field) {
    std::string value = reader.text();
    if (reader.complete()) {
      constexpr std::size_t kLongest = 40;
      value.resize(std::min(value.size(), kLongest));
      std::replace_if(
          value.begin(), value.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
      field = value;
    }
  }
  void byte(int& field) { keep(field, reader.u8()); }
  void word(int& field) { keep(field, reader.u16()); }
  void signed_word(int& field) { keep(field, reader.s16()); }
  void keep(int& field, int value) {
    if (reader.complete()) {
      field = value;
    }
  }
};

struct Encoder {
  WordWriter writer;

  void text(const std::string& field) { writer.text(field); }
  void byte(int field) { writer.u8(field); }
  void word(int field) { writer.u16(field); }
  void signed_word(int field) { writer.u16(field); }
};

}  // namespace

std::optional<ConfigurationPacket> decode_configuration(std::span<const std::uint8_t> payload) {
  constexpr int kMissing = -1;
  ConfigurationPacket packet;
  packet.deceleration = kMissing;
  Decoder decoder{WordReader(payload)};
  visit(packet, decoder);
  if (packet.deceleration == kMissing) {
    return std::nullopt;
  }
  return packet;
}

std::vector<std::uint8_t> encode_configuration(const ConfigurationPacket& packet) {
  Encoder encoder;
  visit(packet, encoder);
  return encode_packet(packet_type::kConfiguration, encoder.writer.bytes());
}

}  // namespace luminav
