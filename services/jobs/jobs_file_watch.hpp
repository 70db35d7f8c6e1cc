#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "services/common/configuration/file_versions.hpp"
#include "services/common/tours/jobs_file.hpp"

namespace luminav {

/// The jobs file of a service that runs: people change it meanwhile, on the page or by hand.
class JobsFileWatch {
 public:
  explicit JobsFileWatch(std::filesystem::path file) : file_(std::move(file)) {}

  /// What it says, if that is new; a file that is gone says nothing. One that cannot be read changes nothing, and is
  /// read again each time: the building may get the place that it misses.
  std::optional<JobsFile> look(const Building& building);
  /// Why what it says does not hold; "" = it does.
  [[nodiscard]] const std::string& objection() const { return objection_; }

 private:
  FileVersions file_;
  bool has_looked_ = false;
  decltype(std::declval<FileVersions>().stamp()) stamp_;  // of what was read last
  std::string objection_;
};

}  // namespace luminav
