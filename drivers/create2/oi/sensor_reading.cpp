#include "drivers/create2/oi/sensor_reading.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr std::array<std::uint8_t, 11> kWanted = {7, 9, 10, 11, 12, 14, 21, 22, 35, 43, 44};

bool bit(int value, int number) {
  return ((value >> number) & 1) != 0;
}

int bits(bool b4, bool b3, bool b2, bool b1, bool b0) {
  return (b4 ? 16 : 0) | (b3 ? 8 : 0) | (b2 ? 4 : 0) | (b1 ? 2 : 0) | (b0 ? 1 : 0);
}

/// Takes one reading's value; false when it says the impossible.
bool take(SensorReading& reading, std::uint8_t id, int value) {
  const auto word = static_cast<std::uint16_t>(value);
  switch (id) {
    case 7:
      reading.bump_right = bit(value, 0);
      reading.bump_left = bit(value, 1);
      reading.wheel_drop_right = bit(value, 2);
      reading.wheel_drop_left = bit(value, 3);
      break;
    case 9:
      reading.cliff_left = value != 0;
      break;
    case 10:
      reading.cliff_front_left = value != 0;
      break;
    case 11:
      reading.cliff_front_right = value != 0;
      break;
    case 12:
      reading.cliff_right = value != 0;
      break;
    case 14:
      reading.overcurrent_right = bit(value, 3);
      reading.overcurrent_left = bit(value, 4);
      break;
    case 21:
      reading.charging_state = value;
      return value <= 5;
    case 22:
      reading.voltage = 1e-3 * word;
      break;
    case 35:
      reading.mode = static_cast<OiMode>(value);
      return value <= 3;
    case 43:
      reading.left_count = word;
      break;
    case 44:
      reading.right_count = word;
      break;
    default:
      break;
  }
  return true;
}

int value_of(const SensorReading& reading, std::uint8_t id) {
  switch (id) {
    case 7:
      return bits(false, reading.wheel_drop_left, reading.wheel_drop_right, reading.bump_left, reading.bump_right);
    case 9:
      return reading.cliff_left ? 1 : 0;
    case 10:
      return reading.cliff_front_left ? 1 : 0;
    case 11:
      return reading.cliff_front_right ? 1 : 0;
    case 12:
      return reading.cliff_right ? 1 : 0;
    case 14:
      return bits(reading.overcurrent_left, reading.overcurrent_right, false, false, false);
    case 21:
      return reading.charging_state;
    case 22:
      return static_cast<int>(std::lround(1000.0 * reading.voltage));
    case 35:
      return static_cast<int>(reading.mode);
    case 43:
      return reading.left_count;
    case 44:
      return reading.right_count;
    default:
      return 0;
  }
}

}  // namespace

std::span<const std::uint8_t> wanted_readings() {
  return kWanted;
}

int reading_size(std::uint8_t id) {
  if (std::find(kWanted.begin(), kWanted.end(), id) == kWanted.end()) {
    return 0;
  }
  const bool is_word = id == 22 || id == 43 || id == 44;
  return is_word ? 2 : 1;
}

std::size_t readings_size() {
  std::size_t size = 0;
  for (const std::uint8_t id : wanted_readings()) {
    size += 1 + static_cast<std::size_t>(reading_size(id));
  }
  return size;
}

std::optional<SensorReading> decode_readings(std::span<const std::uint8_t> payload) {
  SensorReading reading;
  for (const std::uint8_t id : wanted_readings()) {
    const auto size = static_cast<std::size_t>(reading_size(id));
    if (payload.size() < 1 + size || payload[0] != id) {
      return std::nullopt;
    }
    const int value = size == 2 ? (payload[1] << 8) | payload[2] : payload[1];
    if (!take(reading, id, value)) {
      return std::nullopt;
    }
    payload = payload.subspan(1 + size);
  }
  return payload.empty() ? std::optional(reading) : std::nullopt;
}

std::vector<std::uint8_t> encode_readings(const SensorReading& reading, std::span<const std::uint8_t> ids) {
  std::vector<std::uint8_t> payload;
  for (const std::uint8_t id : ids) {
    const int value = value_of(reading, id);
    const int size = reading_size(id);
    if (size > 0) {
      payload.push_back(id);
    }
    if (size == 2) {
      payload.push_back(static_cast<std::uint8_t>((value >> 8) & 0xFF));
    }
    if (size > 0) {
      payload.push_back(static_cast<std::uint8_t>(value & 0xFF));
    }
  }
  return payload;
}

}  // namespace luminav
