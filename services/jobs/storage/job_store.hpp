#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "services/jobs/job_queue.hpp"

namespace luminav {

/// Where and when a job service runs; what is read of the machine is read by `main`.
struct JobCircumstances {
  std::string boot{};      // id of the machine's start; "" = unknown
  std::string building{};  // its name
  std::int64_t utime = 0;  // [us] stamp of the robot; 0 = none yet
  bool ended = false;      // in order: it goes on only when somebody says so
};

struct StoredJobs {
  JobTable table{};
  JobCircumstances kept{};
};

/// Why the jobs that are left over must not move the robot by themselves, in one plain sentence; "" = they may: the
/// service crashed a moment ago.
std::string objection_to_going_on(const JobCircumstances& kept, const JobCircumstances& now);

/// Keeps the table of jobs over a restart, as JSON.
class JobStore {
 public:
  /// "" = keeps nothing.
  explicit JobStore(const std::filesystem::path& folder);

  /// Writes it unless it lies there already. What a person asked for is on the disk when this returns. Throws
  /// std::runtime_error when it cannot be written.
  void keep(const StoredJobs& stored);
  /// Nothing where there is no file. Throws ConfigurationError when it is damaged: nobody's jobs are thrown away.
  [[nodiscard]] std::optional<StoredJobs> recall() const;

 private:
  std::filesystem::path file_;
  std::string kept_;
};

}  // namespace luminav
