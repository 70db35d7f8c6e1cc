#pragma once

#include <luminav/job_status_t.hpp>
#include <luminav/job_t.hpp>
#include <string>
#include <vector>

namespace luminav {

/// A request from what a person typed, without id and stamp: `go PLACE`, `go X Y [HEADING]`, `guide PLACE`, `carry FROM
/// TO`, `tour NAME`, `tour PLACE PLACE ...`, `home`, `confirm [JOB] [WORD]`, `cancel [JOB]`, `answer [JOB] WORDS`. JOB
/// is the end of a job's number; where only one job can be meant it is left out. Throws ConfigurationError that says
/// what is allowed.
job_t make_job(const std::vector<std::string>& words, const job_status_t& status);

/// The queue for people, a line or two for each job.
std::string page_of(const job_status_t& status);
/// One line.
std::string line_of(const job_state_t& job);
/// The same for programs.
std::string json_of(const job_status_t& status);

}  // namespace luminav
