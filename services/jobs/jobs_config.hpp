#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/jobs/job_executor.hpp"

namespace luminav {

/// Everything the job service is told at start.
struct JobsConfig {
  RobotDescription robot;
  JobParams params;
  JobSite site;
  std::string speech = "off";            // language in which espeak-ng says aloud what a job tells people
  std::filesystem::path state_folder{};  ///< where the table of jobs lies; "" = nowhere
  std::string boot{};                    ///< id of the machine's start; "" = unknown
};

/// Reads table [jobs] of the robot's file, the building's places, and the building's jobs file: `jobs_file`, or
/// jobs.toml beside the building's file where there is one. Throws ConfigurationError, also for a home or a stop of a
/// tour that the building does not know.
JobsConfig read_jobs_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file,
                            const std::filesystem::path& jobs_file = {});

}  // namespace luminav
