#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/jobs/job.hpp"

namespace luminav {

/// Time of day where the robot is, as it is told.
struct LocalTime {
  int day = 0;      // counts up by one each midnight
  int weekday = 0;  // 0 = Monday
  int second = 0;   // [s] since midnight
};

/// A tour of the building's jobs file.
struct StoredTour {
  std::string name{};
  std::vector<JobStop> stops{};
  std::optional<int> at{};  // [s] since midnight; nothing = only when somebody asks for it
  std::array<bool, 7> days{true, true, true, true, true, true, true};  // Monday first
};

/// "09:30" as seconds since midnight; nothing when it is no time of day.
std::optional<int> read_time_of_day(const std::string& text);
/// "Mo-Fr", "Sa,Su", "Mo, We-Fr"; nothing when it is no such list.
std::optional<std::array<bool, 7>> read_days(const std::string& text);

/// Those whose time came in the last two minutes and that were not started today. What lies farther back, because the
/// robot was off or a clock was set, is not made up for; a clock that is set back starts nothing a second time.
std::vector<const StoredTour*> due_tours(const std::vector<StoredTour>& tours, const LocalTime& now,
                                         const std::map<std::string, int>& started);

}  // namespace luminav
