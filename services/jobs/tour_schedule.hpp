#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/common/tours/tour.hpp"

namespace luminav {

/// Time of day where the robot is, as it is told.
struct LocalTime {
  int day = 0;      // counts up by one each midnight
  int weekday = 0;  // 0 = Monday
  int second = 0;   // [s] since midnight
};

/// Those whose time came in the last two minutes and that were not started today. What lies farther back, because the
/// robot was off or a clock was set, is not made up for; a clock that is set back starts nothing a second time.
std::vector<const Tour*> due_tours(const std::vector<Tour>& tours, const LocalTime& now,
                                   const std::map<std::string, int>& started);

}  // namespace luminav
