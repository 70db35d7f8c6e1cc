#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace luminav {

/// Opcodes of iRobot's Open Interface that are used here.
enum class OiOpcode : std::uint8_t {
  kStart = 128,        // opens the interface, in passive mode: the wheels have no power
  kSafe = 131,         // motors under control; the robot itself leaves it at a cliff, a dropped wheel and the charger
  kFull = 132,         // the same without the robot's own protection: not used to drive
  kDriveDirect = 145,  // speed of each wheel
  kStream = 148,       // readings every 15 ms from now on
  kPauseStream = 150,  // 0 pauses, 1 resumes
};

/// What the robot says of its mode, reading 35.
enum class OiMode : std::uint8_t { kOff = 0, kPassive = 1, kSafe = 2, kFull = 3 };

/// Number of data bytes behind an opcode; for the stream that of the first byte alone. Nothing for an unknown one,
/// which the robot ignores.
int oi_data_size(std::uint8_t opcode);

constexpr int kOiMaxWheelSpeed = 500;  // [mm/s] faster is cut off by the robot

/// With an edge under a cliff sensor the robot leaves safe mode rather than drive so: forward, on the spot, or back in
/// an arc narrower than itself. [m/s], [rad/s]
bool leads_over_an_edge(double linear, double angular);

std::vector<std::uint8_t> encode_opcode(OiOpcode opcode);
/// Wheel speeds [mm/s], forward positive, clipped to what the robot can.
std::vector<std::uint8_t> encode_drive_direct(int left_mm_s, int right_mm_s);
std::vector<std::uint8_t> encode_stream_request(std::span<const std::uint8_t> ids);
/// Stands whatever came before: a command that was cut off in the middle takes at most four zeros for its data, and
/// what is left of them is no opcode.
std::vector<std::uint8_t> encode_halt();

}  // namespace luminav
