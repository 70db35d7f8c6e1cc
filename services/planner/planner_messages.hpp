#pragma once

#include <cstdint>
#include <luminav/goal_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/path_t.hpp>

#include "services/planner/execution/goal_executor.hpp"

namespace luminav {

/// What GOAL asks for, of one that was found sound.
GoalRequest request_from(const goal_t& message);

path_t path_message(const GoalPath& path, std::int64_t utime);
navigation_status_t navigation_message(const NavigationReport& report, const GoalPath& path, std::int64_t utime);

}  // namespace luminav
