#include "tests/evaluation/suites.hpp"

#include <fmt/format.h>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

struct NamedEntry {
  const char* suite;
  const char* scenario;  // below launch/scenarios
  std::uint64_t first_seed;
  std::uint64_t last_seed;
};

// Seeds of 1000 and above are for measuring only; what is tuned is tuned on smaller ones.
constexpr NamedEntry kEntries[] = {
    {"quick", "laboratory.toml", 1, 2},
    {"laboratory", "laboratory.toml", 1000, 1019},
    {"laboratory", "laboratory-dark.toml", 1000, 1019},
    {"office", "office.toml", 1000, 1009},
};

}  // namespace

std::string suite_names() {
  std::string names;
  std::string last;
  for (const NamedEntry& entry : kEntries) {
    if (last != entry.suite) {
      names += (names.empty() ? "" : ", ") + std::string(entry.suite);
      last = entry.suite;
    }
  }
  return names + ", all";
}

std::vector<SuiteEntry> suite_entries(const std::string& suite) {
  const std::filesystem::path folder = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/scenarios";
  std::vector<SuiteEntry> entries;
  for (const NamedEntry& entry : kEntries) {
    if (suite == entry.suite || suite == "all") {
      entries.push_back({folder / entry.scenario, entry.first_seed, entry.last_seed});
    }
  }
  if (entries.empty()) {
    throw ConfigurationError(fmt::format("--suite {}: must be one of {}", suite, suite_names()));
  }
  return entries;
}

}  // namespace luminav
