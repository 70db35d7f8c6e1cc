#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/common/calendar/hours.hpp"
#include "services/jobs/job.hpp"

namespace luminav {

/// A tour of the building's jobs file.
struct StoredTour {
  std::string name{};
  std::vector<JobStop> stops{};
  std::optional<int> at{};  // [s] since midnight; nothing = only when somebody asks for it
  Days days = kEveryDay;
};

/// Those whose time came in the last two minutes and that were not started today. What lies farther back, because the
/// robot was off or a clock was set, is not made up for; a clock that is set back starts nothing a second time.
std::vector<const StoredTour*> due_tours(const std::vector<StoredTour>& tours, const LocalTime& now,
                                         const std::map<std::string, int>& started);

}  // namespace luminav
