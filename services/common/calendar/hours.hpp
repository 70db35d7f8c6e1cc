#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "services/common/calendar/local_time.hpp"

namespace luminav {

using Days = std::array<bool, 7>;  // Monday first
inline constexpr Days kEveryDay = {true, true, true, true, true, true, true};
inline constexpr int kDaySeconds = 86'400;

/// The hours of the week in which something holds. Always, unless said otherwise.
struct Hours {
  int begin = 0;          // [s] since midnight
  int end = kDaySeconds;  // [s] since midnight, not included; before `begin`: of the next day
  Days days = kEveryDay;  // on which they begin

  bool operator==(const Hours&) const = default;
};

inline bool are_always(const Hours& hours) {
  return hours == Hours{};
}
bool hold(const Hours& hours, const LocalTime& now);
/// When hours that hold at such a time end: "12:00", or after whole days "Sa 00:00"; "" = never.
std::string end_of(const Hours& hours, const LocalTime& now);
/// True if both hold in some minute of the week.
bool meet(const Hours& a, const Hours& b);

/// "09:30" as seconds since midnight; nothing when it is no time of day.
std::optional<int> read_time_of_day(const std::string& text);
/// The other way round, to the minute.
std::string time_of_day_text(int seconds);
/// "08:00-12:00" or, over midnight, "22:00-06:00", as begin and end; nothing when it is neither.
std::optional<std::pair<int, int>> read_span(const std::string& text);
/// "Mo-Fr", "Sa,Su", "Mo, We-Fr"; nothing when it is no such list.
std::optional<Days> read_days(const std::string& text);

/// As `read_span` takes it; "" = the whole day.
std::string span_text(const Hours& hours);
/// As `read_days` takes it; "" = every day.
std::string days_text(const Days& days);
/// Both for a person: "Mo-Fr 08:00-12:00"; "" = always.
std::string text_of(const Hours& hours);

}  // namespace luminav
