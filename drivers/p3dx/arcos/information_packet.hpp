#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace luminav {

/// Types of the packets that a robot sends.
namespace packet_type {
inline constexpr std::uint8_t kSync0 = 0x00;
inline constexpr std::uint8_t kSync1 = 0x01;
inline constexpr std::uint8_t kSync2 = 0x02;
inline constexpr std::uint8_t kConfiguration = 0x20;
inline constexpr std::uint8_t kStanding = 0x32;  // standard information, motors stopped
inline constexpr std::uint8_t kMoving = 0x33;    // standard information; some robots never send it
inline constexpr std::uint8_t kEncoder = 0x90;
inline constexpr std::uint8_t kInputOutput = 0xF0;
inline constexpr std::uint8_t kResetA = 0xFE;  // the controller was reset
inline constexpr std::uint8_t kResetB = 0xFF;  // wrong count of SYNCs, or reset
}  // namespace packet_type

/// 0x30 .. 0x34: standard information of all firmware generations.
[[nodiscard]] inline bool is_information(std::uint8_t type) {
  return type >= 0x30 && type <= 0x34;
}

/// One echo, or its absence, of a sonar disc.
struct SonarReading {
  int disc = 0;      // 0..31
  int range_mm = 0;  // 5000 = nothing echoed
};

/// The standard information packet (SIP), in the robot's own units.
struct InformationPacket {
  bool moving = false;  // from the type; not to be trusted, see p2os-derived simulators
  int x_mm = 0;         // 16 bits that wrap; robots disagree on 15 or 16, differences modulo 32768 are right for all
  int y_mm = 0;         // + = left
  int heading = 0;      // 4096 units per turn, counter-clockwise, wraps
  int left_mm_s = 0;
  int right_mm_s = 0;
  double battery_voltage = 0.0;  // [V]
  bool stall_left = false;
  bool stall_right = false;
  int bumpers_rear = 0;      // bits 1-7 of the word's low byte, shifted down
  int bumpers_front = 0;     // bits 1-7 of its high byte, shifted down
  int heading_setpoint = 0;  // angle units
  bool motors_enabled = false;
  int sonar_arrays = 0;            // bit mask, bit 0 = array 1
  bool stop_button = false;        // pressed
  bool stop_button_stall = false;  // E_STALL engaged
  bool charger_power = false;
  int compass = 0;                  // 2-degree units
  std::vector<SonarReading> sonar;  // since the last packet, in the order sent
  // Older firmware ends somewhere below.
  bool has_extension = false;  // the fields up to DIGOUT were there
  int digital_in = 0;
  int digital_out = 0;
  int analog_port = 0;
  int analog = 0;
  std::optional<int> charge_state;  // 0 none, 1 bulk, 2 overcharge, 3 float, 4 balance; 0xFF unknown
  std::optional<int> turn_rate;     // 0.1 degrees/s
  int fault_flags = 0;
  std::optional<int> temperature;      // [deg C]
  std::optional<int> state_of_charge;  // [%]
};

/// Reads a SIP by its remaining length, never by a fixed size. Nothing when even the fixed part is cut, when the sonar
/// count claims more than there is, or when a disc number is above 31.
std::optional<InformationPacket> decode_information(std::uint8_t type, std::span<const std::uint8_t> payload);
/// The whole frame, with the tail of current firmware up to the state of charge.
std::vector<std::uint8_t> encode_information(const InformationPacket& packet);

/// Who a robot says that it is, in the answer to SYNC2.
struct RobotIdentity {
  std::string name;
  std::string robot_class;
  std::string subclass;
};
/// Texts cut at 40 bytes, unprintable bytes replaced; a missing NUL is forgiven.
RobotIdentity decode_identity(std::span<const std::uint8_t> payload);
std::vector<std::uint8_t> encode_identity(const RobotIdentity& identity);

/// ENCODERpac: wrapping ticks of both wheels.
struct EncoderPacket {
  std::int32_t left = 0;
  std::int32_t right = 0;
};
std::optional<EncoderPacket> decode_encoder(std::span<const std::uint8_t> payload);
std::vector<std::uint8_t> encode_encoder(const EncoderPacket& packet);

/// IOpac: digital and analog inputs; bumper bits are raw.
struct InputOutputPacket {
  std::vector<int> digital_in;  // digital inputs, front bumpers, rear bumpers, infrared
  std::vector<int> digital_out;
  std::vector<int> analog;  // 10 bits
};
std::optional<InputOutputPacket> decode_input_output(std::span<const std::uint8_t> payload);
std::vector<std::uint8_t> encode_input_output(const InputOutputPacket& packet);

}  // namespace luminav
