#include "drivers/create2/safety/oi_guard.hpp"

#include "drivers/create2/oi/sensor_reading.hpp"
#include "drivers/create2/oi/stream_parser.hpp"

namespace luminav {

GuardedRobot guarded_create2() {
  GuardedRobot robot;
  robot.halt = encode_halt();
  robot.leave = encode_halt();
  robot.leave.push_back(static_cast<std::uint8_t>(OiOpcode::kStart));  // passive
  robot.hear_wheels = [parser = StreamParser(), last = std::optional<SensorReading>(),
                       size = readings_size()](std::span<const std::uint8_t> bytes) mutable {
    std::optional<bool> stand;
    parser.push(bytes);
    while (const auto payload = parser.next(size)) {
      if (const auto reading = decode_readings(*payload)) {
        stand = last && last->left_count == reading->left_count && last->right_count == reading->right_count;
        last = reading;
      }
    }
    return stand;
  };
  return robot;
}

}  // namespace luminav
