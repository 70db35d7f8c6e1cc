#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/p3dx/arcos/arcos_packet.hpp"

namespace luminav {

/// Commands from a client to the robot. Units: mm, mm/s, degrees, degrees/s unless said.
enum class ArcosCommand : std::uint8_t {
  kPulse = 0,                // keep-alive; SYNC0 before the session
  kOpen = 1,                 // SYNC1 before the session
  kClose = 2,                // SYNC2 before the session
  kPolling = 3,              // text: order of sonar discs, counted from 1
  kEnable = 4,               // 1 = motors on
  kSetAcceleration = 5,      // SETA, mm/s^2; negative sets the deceleration
  kSetMaximumVelocity = 6,   // SETV
  kSetOrigin = 7,            // SETO
  kMove = 8,                 // relative distance
  kRotate = 9,               // as kTurnRate
  kSetMaximumTurnRate = 10,  // SETRV
  kVelocity = 11,            // VEL, forward
  kHeading = 12,             // HEAD, absolute, counter-clockwise
  kTurnBy = 13,              // DHEAD
  kSay = 15,                 // text: pairs of duration and tone
  kJoystickRequest = 17,
  kConfiguration = 18,        // asks for the configuration packet
  kEncoder = 19,              // 0 stop, 1 once, 2 stream
  kTurnRate = 21,             // RVEL, counter-clockwise
  kTurnFromSetpoint = 22,     // DCHEAD
  kSetTurnAcceleration = 23,  // SETRA, degrees/s^2; negative sets the deceleration
  kSonar = 28,                // bit 0 on, bits 1-3 array 1..4, 0 = all
  kStop = 29,                 // stops with the deceleration set; motors stay on
  kDigitalOut = 30,           // high byte mask, low byte values
  kWheelVelocities = 32,      // VEL2, units of 20 mm/s, low byte right
  kAnalogSelect = 35,
  kIoRequest = 40,        // 0 stop, 1 once, 2 stream
  kBumpStall = 44,        // 0 none, 1 front, 2 rear, 3 both
  kSonarCycle = 48,       // ms
  kHostBaud = 50,         // 0..4 = 9600, 19200, 38400, 57600, 115200
  kEmergencyStop = 55,    // stops at once, ignoring the deceleration
  kStopButtonStall = 56,  // E_STALL: 1 = the button on the robot disables the motors
  kGyro = 58,
  kBatteryInformation = 62,
  kSound = 92,
  kBatteryTest = 250,  // pretends a voltage in 0.1 V; 0 = the real one
  kReset = 253,
};

/// The argument behind a command, whatever its kind.
struct CommandArgument {
  enum class Kind { kNone, kInteger, kText };
  Kind kind = Kind::kNone;
  int value = 0;                       // of kInteger, with its sign
  std::span<const std::uint8_t> text;  // of kText
};

/// Frames of a command without argument, with an integer (clamped to +-32767, the largest magnitude that all robots
/// take) and with a text (cut at 199 bytes).
std::vector<std::uint8_t> encode_command(ArcosCommand command);
std::vector<std::uint8_t> encode_command(ArcosCommand command, int value);
std::vector<std::uint8_t> encode_command(ArcosCommand command, std::string_view text);

/// Reads the argument of a client's packet. Extra bytes are ignored, a cut or unknown argument is kNone; texts with
/// and without a length byte are understood.
CommandArgument decode_argument(std::span<const std::uint8_t> payload);

/// VEL2: both wheels in units of `Vel2Divisor` (20 mm/s), clamped to +-127.
struct WheelVelocities {
  int left = 0;
  int right = 0;
};
std::vector<std::uint8_t> encode_wheel_velocities(const WheelVelocities& wheels);
/// The sign byte belongs to the whole word: 3B 05 FB and 1B FB 04 are the same command.
WheelVelocities decode_wheel_velocities(int word);

/// Rate of a HOSTBAUD argument [bit/s], or 0; and the reverse, or -1.
int baud_of_code(int code);
int code_of_baud(int baud);

}  // namespace luminav
