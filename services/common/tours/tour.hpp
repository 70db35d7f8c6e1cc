#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace luminav {

/// Days of a week, Monday first.
using Weekdays = std::array<bool, 7>;
inline constexpr Weekdays kEveryDay{true, true, true, true, true, true, true};

/// Where a stored tour leads.
struct TourStop {
  std::string place{};  ///< of the building
  double pause = 0.0;   ///< [s] to stay there
  std::string text{};   ///< for people there
  bool photo = false;   ///< the camera's picture there is kept
};

/// A tour of the building's jobs file.
struct Tour {
  std::string name{};
  std::vector<TourStop> stops{};
  std::optional<int> at{};  ///< [s] since midnight; nothing = only when somebody asks for it
  Weekdays days = kEveryDay;
};

inline constexpr std::size_t kMaxTours = 50;         // their names fit into one datagram beside the jobs
inline constexpr std::size_t kMaxTourStops = 20;     // as many as a job has
inline constexpr std::size_t kMaxTourText = 200;     // [bytes]
inline constexpr double kLongestTourPause = 3600.0;  // [s]

/// "09:30" as seconds since midnight; nothing when it is no time of day.
std::optional<int> read_time_of_day(const std::string& text);
/// The other way round, to the minute.
std::string time_of_day_text(int second);

/// "Mo-Fr", "Sa,Su", "Mo, We-Fr"; nothing when it is no such list.
std::optional<Weekdays> read_days(const std::string& text);
/// The other way round; three and more in a row as "Mo-Fr".
std::string days_text(const Weekdays& days);

/// True if they are the same in the same order, pauses to the half of a millisecond.
bool are_same_tours(const std::vector<Tour>& a, const std::vector<Tour>& b);

}  // namespace luminav
