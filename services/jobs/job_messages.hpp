#pragma once

#include <luminav/goal_t.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/job_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <optional>
#include <string>

#include "services/jobs/job_executor.hpp"

namespace luminav {

/// Nothing for a message whose numbers stand for nothing.
std::optional<JobRequest> request_from(const job_t& message);
Navigation navigation_from(const navigation_status_t& message);
/// Why the robot must not start now: somebody handles it, or it cannot; "" = it may.
std::string who_handles(const robot_status_t& status);
goal_t goal_from(const DriveRequest& request, std::int64_t utime);
/// All but stamp and sequence.
job_status_t status_from(const JobExecutor& executor);

}  // namespace luminav
