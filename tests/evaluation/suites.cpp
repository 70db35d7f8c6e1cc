#include "tests/evaluation/suites.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/simulator/scenario.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "tests/evaluation/generated_worlds.hpp"
#include "tests/evaluation/mission_scenarios.hpp"

namespace luminav {
namespace {

struct NamedEntry {
  const char* suite;
  const char* scenario;  // below launch/scenarios; a folder: all in it
  std::uint64_t first_seed;
  std::uint64_t last_seed;
  const char* sensing = "rendered";
  bool patrol = false;
};

// Seeds of 1000 and above are for measuring only; what is tuned is tuned on smaller ones.
constexpr NamedEntry kEntries[] = {
    {"quick", "laboratory.toml", 1, 2},
    {"laboratory", "laboratory.toml", 1000, 1019},
    {"laboratory", "laboratory-dark.toml", 1000, 1019},
    {"office", "office.toml", 1000, 1009},
    {"localization", "laboratory.toml", 1000, 1019},
    {"localization", "laboratory-carried.toml", 1000, 1019},
    {"localization", "symmetric-corridor.toml", 1000, 1019},
    {"mapping", "laboratory-mapping.toml", 1000, 1004},
    {"mapping", "office.toml", 1000, 1004},
    {"navigation", "laboratory-crowd.toml", 1000, 1009},
    {"navigation", "navigation", 1000, 1009},
    {"endurance", "laboratory-patrol.toml", 1000, 1000, "geometric", true},
};
// What "all" takes of each scenario at most: half an hour on two cores.
constexpr std::uint64_t kSeedsInAll = 10;
constexpr std::uint64_t kScaleSeedsInAll = 2;  // two minutes for each floor with 4,000 fixtures
constexpr const char* kMeasured[] = {"localization", "mapping", "navigation", "endurance"};

void add_scenarios(const NamedEntry& entry, const std::filesystem::path& path, std::vector<SuiteEntry>& entries) {
  for (const std::filesystem::path& file : scenario_files(path)) {
    entries.push_back({file, entry.first_seed, entry.last_seed, entry.sensing, entry.patrol});
  }
}

}  // namespace

std::vector<std::filesystem::path> scenario_files(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) {
    return {path};
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() == ".toml") {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw ConfigurationError(fmt::format("{}: holds no scenario (*.toml)", path.string()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string suite_names() {
  return "quick, laboratory, office, localization, detector, mapping, navigation, endurance, missions, worlds, scale, "
         "all";
}

bool has_detector_part(const std::string& suite) {
  return suite == "detector" || suite == "all";
}

std::vector<SuiteEntry> suite_entries(const std::string& suite, const std::filesystem::path& generated) {
  const std::filesystem::path folder = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/scenarios";
  std::vector<SuiteEntry> entries;
  for (const NamedEntry& entry : kEntries) {
    const bool in_all = suite == "all" && std::find(std::begin(kMeasured), std::end(kMeasured),
                                                    std::string_view(entry.suite)) != std::end(kMeasured);
    if (suite == entry.suite || in_all) {
      add_scenarios(entry, folder / entry.scenario, entries);
    }
  }
  if (suite == "worlds" || suite == "all") {
    for (const auto& file : make_worlds(generated)) {
      entries.push_back({file, 1000, 1019, "rendered", false});
    }
  }
  if (suite == "scale" || suite == "all") {
    for (const auto& file : make_scale_series(generated)) {
      entries.push_back({file, 1000, suite == "all" ? 999 + kScaleSeedsInAll : 1004, "geometric", false});
    }
  }
  if (suite == "missions" || suite == "all") {
    for (const auto& file : make_missions(generated)) {
      const std::uint64_t seed = read_scenario(file).seed;
      entries.push_back({file, seed, seed, "geometric", false});
    }
  }
  // "all" would do some twice: the laboratory is one of the worlds too
  std::vector<SuiteEntry> once;
  for (const SuiteEntry& entry : entries) {
    const bool known = std::any_of(once.begin(), once.end(), [&](const SuiteEntry& other) {
      return other.scenario == entry.scenario && other.first_seed == entry.first_seed;
    });
    if (!known) {
      once.push_back(entry);
      if (suite == "all") {
        once.back().last_seed = std::min(entry.last_seed, entry.first_seed + kSeedsInAll - 1);
      }
    }
  }
  if (once.empty() && !has_detector_part(suite)) {
    throw ConfigurationError(fmt::format("--suite {}: must be one of {}", suite, suite_names()));
  }
  return once;
}

}  // namespace luminav
