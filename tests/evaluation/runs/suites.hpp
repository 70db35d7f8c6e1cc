#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace luminav {

/// A scenario and the seeds it is run with.
struct SuiteEntry {
  std::filesystem::path scenario;
  std::uint64_t first_seed = 1;
  std::uint64_t last_seed = 1;
  std::string sensing = "rendered";  // unless the user wants another one
  bool patrol = false;               // the goals are driven to over and over until the scenario's duration is over
  std::string suite;                 // that it belongs to, also within "all"; "" = none
  std::string group;                 // under which its runs are summed up; "" = the scenario's name
  std::string mode{};                // of all nodes that have two, told apart by the run's name; "" = as asked for
};

/// The scenario itself, or all scenarios of a folder, by name. Throws ConfigurationError for a folder without any.
std::vector<std::filesystem::path> scenario_files(const std::filesystem::path& path);

/// "quick, localization, ..."
std::string suite_names();
/// Buildings and scenarios that a suite makes itself are written below `generated`; what is there already is used.
/// Throws ConfigurationError for a name that no suite has.
std::vector<SuiteEntry> suite_entries(const std::string& suite, const std::filesystem::path& generated);
/// True for the suites that measure the detector alone: over a lighting matrix, under mistakes of the files, or below
/// each kind of luminaire.
bool has_detector_part(const std::string& suite);

}  // namespace luminav
