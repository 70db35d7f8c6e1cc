#include "services/jobs/jobs_file_watch.hpp"

#include <exception>

namespace luminav {

std::optional<JobsFile> JobsFileWatch::look(const Building& building) {
  try {
    const auto stamp = file_.stamp();
    if (has_looked_ && stamp == stamp_ && objection_.empty()) {
      return std::nullopt;
    }
    has_looked_ = true;
    stamp_ = stamp;
    JobsFile jobs = read_jobs_file(file_.file(), building);
    objection_.clear();
    return jobs;
  } catch (const std::exception& error) {
    objection_ = error.what();
    return std::nullopt;
  }
}

}  // namespace luminav
