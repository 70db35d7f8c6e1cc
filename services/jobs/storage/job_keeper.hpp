#pragma once

#include <cstdint>
#include <string>

#include "services/jobs/job_executor.hpp"
#include "services/jobs/jobs_config.hpp"
#include "services/jobs/storage/job_store.hpp"

namespace luminav {

/// Keeps an executor's jobs on the disk, and decides whether those that the process before left over go on by
/// themselves.
class JobKeeper {
 public:
  /// Loads what lies on the disk. Throws ConfigurationError when it is damaged.
  JobKeeper(const JobsConfig& config, JobExecutor& executor);

  /// A stamp of the robot [us]. At the first one, jobs that were left over go on, or ask.
  void tick(std::int64_t utime);
  /// False when the disk takes nothing.
  bool keep();
  /// Keeps them for the last time: the service is ended in order.
  void end();
  /// Why the disk takes nothing; "" = it does.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  JobExecutor& executor_;
  JobStore store_;
  JobCircumstances here_;     // of this process
  JobCircumstances kept_;     // as the table has them; those of the process before until the robot is heard
  bool has_gone_on_ = false;  // with what the process before left over
  std::string error_;
};

}  // namespace luminav
