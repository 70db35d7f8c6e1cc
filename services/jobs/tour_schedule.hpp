#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/common/calendar/local_time.hpp"
#include "services/common/tours/tour.hpp"

namespace luminav {

/// Those whose time came in the last two minutes and that were not started today. What lies farther back, because the
/// robot was off or a clock was set, is not made up for; a clock that is set back starts nothing a second time.
std::vector<const Tour*> due_tours(const std::vector<Tour>& tours, const LocalTime& now,
                                   const std::map<std::string, int>& started);

}  // namespace luminav
