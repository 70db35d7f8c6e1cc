#pragma once

#include <filesystem>

#include "services/jobs/job_executor.hpp"

namespace luminav {

/// Reads a building's jobs.toml into a site whose places are known: `home`, `charger` and [[tour]]. Throws
/// ConfigurationError, also for a place that the building does not have.
void read_jobs_file(const std::filesystem::path& file, JobSite& site);

}  // namespace luminav
