#include "services/common/calendar/local_time.hpp"

#include <ctime>

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]
constexpr std::int64_t kDay = 86'400;        // [s]
constexpr std::int64_t kFirstWeekday = 3;    // 1 January 1970 was a Thursday

std::int64_t floor_divide(std::int64_t value, std::int64_t by) {
  return value / by - (value % by < 0 ? 1 : 0);
}

}  // namespace

LocalTime universal_time(std::int64_t utime) {
  const std::int64_t seconds = floor_divide(utime, kSecond);
  const std::int64_t day = floor_divide(seconds, kDay);
  const std::int64_t weekday = day + kFirstWeekday - 7 * floor_divide(day + kFirstWeekday, 7);
  return {static_cast<int>(day), static_cast<int>(weekday), static_cast<int>(seconds - kDay * day)};
}

LocalTime local_time(std::int64_t utime) {
  const std::time_t seconds = floor_divide(utime, kSecond);
  std::tm local{};
  localtime_r(&seconds, &local);
  return universal_time(utime + kSecond * local.tm_gmtoff);
}

LocalClock ahead_of_universal(std::int64_t seconds) {
  return [seconds](std::int64_t utime) { return universal_time(utime + kSecond * seconds); };
}

std::optional<std::int64_t> read_utc_offset(const std::string& text) {
  const bool has_sign = !text.empty() && (text.front() == '+' || text.front() == '-');
  if (!has_sign || text.size() != 5 || text.find_first_not_of("0123456789", 1) != std::string::npos) {
    return std::nullopt;
  }
  const int hours = std::stoi(text.substr(1, 2));
  const int minutes = std::stoi(text.substr(3));
  if (hours > 15 || minutes > 59) {
    return std::nullopt;
  }
  return (text.front() == '-' ? -60 : 60) * (60 * hours + minutes);
}

}  // namespace luminav
