#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace luminav {

/// Time of day where the robot is.
struct LocalTime {
  int day = 0;      // counts up by one each midnight
  int weekday = 0;  // 0 = Monday
  int second = 0;   // [s] since midnight
};

/// What makes a stamp [us] a time of day. A node is given one, since a machine's time zone is not in its messages:
/// processes take `local_time`, replays and simulated robots what is the same on every machine.
using LocalClock = std::function<LocalTime(std::int64_t utime)>;

/// By the time zone of this machine, or of the environment's TZ.
LocalTime local_time(std::int64_t utime);
/// By Greenwich.
LocalTime universal_time(std::int64_t utime);
/// By a clock that is so many seconds ahead of Greenwich's.
LocalClock ahead_of_universal(std::int64_t seconds);
/// "+0100", as date +%z has it, in seconds; nothing when it is no such offset.
std::optional<std::int64_t> read_utc_offset(const std::string& text);

}  // namespace luminav
