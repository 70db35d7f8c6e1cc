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
};

/// "quick, laboratory, ..."
std::string suite_names();
/// Throws ConfigurationError for a name that no suite has.
std::vector<SuiteEntry> suite_entries(const std::string& suite);

}  // namespace luminav
