#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/tours/tour.hpp"

namespace luminav {

/// What a building's jobs.toml says.
struct JobsFile {
  std::string home{};        // name of a place; "" = none
  bool has_charger = false;  // there
  std::vector<Tour> tours{};
};

/// That, and the line of the file on which each table begins, in the same order.
struct JobsSource {
  struct TourLines {
    int tour = 0;
    std::vector<int> stops{};
  };
  JobsFile jobs{};
  std::vector<TourLines> lines{};
};

/// Where a building has its jobs file unless somebody says otherwise: jobs.toml beside its own.
std::filesystem::path jobs_file_of(const std::filesystem::path& building_file);

/// Reads it strictly: `home`, `charger` and [[tour]]. Throws ConfigurationError, also for a place that the building
/// does not have.
JobsSource read_jobs_source(const std::filesystem::path& file, const Building& building);
/// The same; a file that is not there says nothing.
JobsFile read_jobs_file(const std::filesystem::path& file, const Building& building);

}  // namespace luminav
