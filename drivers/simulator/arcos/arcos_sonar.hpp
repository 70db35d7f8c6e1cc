#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

namespace luminav {

/// When which sonar disc of the simulated controller fires: one disc per array and cycle, arrays in parallel.
class ArcosSonar {
 public:
  /// With `all_at_once` every disc fires in each cycle and each information packet repeats all of them.
  ArcosSonar(const ConfigurationPacket& flash, bool all_at_once);

  /// SONAR: bit 0 on or off, bits 1-3 the array (0 = all).
  void switch_arrays(int argument);
  /// POLLING: discs counted from 1; arrays that are not named keep theirs, an empty list switches all off.
  void set_polling(std::span<const std::uint8_t> discs);
  void set_cycle(int milliseconds);

  /// Discs that fire when time goes on by `microseconds`.
  std::vector<int> step(std::int64_t microseconds);
  void set_reading(int disc, double range);
  /// Readings for an information packet; each is given once.
  std::vector<SonarReading> take_readings();

  [[nodiscard]] int arrays_on() const;  // bit mask

 private:
  static constexpr int kArrays = 2;
  static constexpr int kDiscsPerArray = 8;
  struct Array {
    bool fitted = false;
    bool on = false;
    std::vector<int> order;  // discs counted from 0
    std::size_t next = 0;
  };
  std::array<Array, kArrays> arrays_;
  std::int64_t cycle_;       // [us]
  std::int64_t until_ping_;  // [us]
  bool all_at_once_;
  std::vector<SonarReading> readings_;
};

}  // namespace luminav
