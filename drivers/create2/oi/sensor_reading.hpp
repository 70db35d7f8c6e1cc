#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/create2/oi/oi_commands.hpp"

namespace luminav {

/// All readings that the driver asks for, as of one moment: few enough for a line of 19200 bit/s. Numbers are those of
/// the Open Interface.
struct SensorReading {
  bool bump_left = false;  // 7, bits 1 and 0
  bool bump_right = false;
  bool wheel_drop_left = false;  // 7, bits 3 and 2
  bool wheel_drop_right = false;
  bool cliff_left = false;  // 9 to 12
  bool cliff_front_left = false;
  bool cliff_front_right = false;
  bool cliff_right = false;
  bool overcurrent_left = false;  // 14, bits 4 and 3: the wheel is blocked
  bool overcurrent_right = false;
  int charging_state = 0;         // 21: 0 no, 1 reconditioning, 2 full, 3 trickle, 4 waiting, 5 fault
  double voltage = 0.0;           // [V] 22
  OiMode mode = OiMode::kOff;     // 35
  std::uint16_t left_count = 0;   // 43, encoder, wraps at 16 bits
  std::uint16_t right_count = 0;  // 44
};

/// Ids of the readings that the driver asks for, in the order in which they stand in a frame.
std::span<const std::uint8_t> wanted_readings();
/// Bytes of the data of a reading; 0 = unknown here.
int reading_size(std::uint8_t id);

/// Bytes of all wanted readings with their ids.
std::size_t readings_size();

/// From what stands between length and checksum of a stream frame. Nothing when it is not exactly what was asked for.
std::optional<SensorReading> decode_readings(std::span<const std::uint8_t> payload);
/// The other way round, for the simulated robot: those of `ids` that are known here.
std::vector<std::uint8_t> encode_readings(const SensorReading& reading, std::span<const std::uint8_t> ids);

}  // namespace luminav
