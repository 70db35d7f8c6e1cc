#include "services/jobs/jobs_file_watch.hpp"

#include <exception>

namespace luminav {

std::optional<JobsFile> JobsFileWatch::look(const Building& building) {
  try {
    Written written{};
    if (std::filesystem::exists(file_)) {
      written = {std::filesystem::last_write_time(file_), std::filesystem::file_size(file_)};
    }
    if (written == written_ && objection_.empty()) {
      return std::nullopt;
    }
    written_ = written;
    JobsFile jobs = read_jobs_file(file_, building);
    objection_.clear();
    return jobs;
  } catch (const std::exception& error) {
    objection_ = error.what();
    return std::nullopt;
  }
}

}  // namespace luminav
