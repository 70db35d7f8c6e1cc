#include "tests/evaluation/runs/suites.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "tests/evaluation/runs/drawn/drawn_buildings.hpp"
#include "tests/evaluation/runs/drawn/mishaps.hpp"
#include "tests/evaluation/runs/generated_worlds.hpp"
#include "tests/evaluation/runs/mission_scenarios.hpp"
#include "tests/evaluation/runs/zone_scenarios.hpp"

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

// Seeds of 1000 and above are for measuring only; what is tuned is tuned on smaller ones. As many as end within
// minutes;
// --seeds takes more.
constexpr NamedEntry kEntries[] = {
    {"quick", "laboratory.toml", 1, 2},
    {"laboratory", "laboratory.toml", 1000, 1009},
    {"laboratory", "laboratory-dark.toml", 1000, 1009},
    {"office", "office.toml", 1000, 1009},
    {"localization", "laboratory.toml", 1000, 1009},
    {"localization", "laboratory-carried.toml", 1000, 1009},
    {"localization", "symmetric-corridor.toml", 1000, 1009},
    {"mapping", "laboratory-mapping.toml", 1000, 1002},
    {"mapping", "office.toml", 1000, 1002},
    {"mapping", "office-mapping.toml", 1000, 1000, "geometric"},
    {"navigation", "laboratory-crowd.toml", 1000, 1004},
    {"navigation", "navigation", 1000, 1004},
    {"endurance", "laboratory-patrol.toml", 1000, 1000, "geometric", true},
    {"jobs", "laboratory-jobs.toml", 1000, 1009, "geometric"},
    {"jobs", "office-jobs.toml", 1000, 1009, "geometric"},
};
/// What "all" is made of, apart from the detector's part: all seeds, but for generated and drawn worlds, which would
/// take half of its time.
constexpr const char* kAll[] = {"localization", "mapping", "navigation", "endurance", "missions",
                                "zones",        "worlds",  "scale",      "drawn",     "mishaps"};
constexpr std::uint64_t kWorldSeedsInAll = 4;

std::vector<SuiteEntry> named_entries(const std::string& suite) {
  const std::filesystem::path folder = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/scenarios";
  std::vector<SuiteEntry> entries;
  for (const NamedEntry& entry : kEntries) {
    if (suite == entry.suite) {
      for (const std::filesystem::path& file : scenario_files(folder / entry.scenario)) {
        entries.push_back({file, entry.first_seed, entry.last_seed, entry.sensing, entry.patrol, suite, ""});
      }
    }
  }
  return entries;
}

std::vector<SuiteEntry> made_entries(const std::string& suite, const std::filesystem::path& generated) {
  std::vector<SuiteEntry> entries;
  if (suite == "worlds") {
    for (const auto& file : make_worlds(generated)) {
      entries.push_back({file, 1000, 1019, "rendered", false, suite, ""});
    }
  } else if (suite == "drawn" || suite == "mishaps") {
    for (const auto& file : suite == "drawn" ? make_drawn_buildings(generated) : make_mishaps(generated)) {
      entries.push_back({file, 1000, 1009, "geometric", false, suite, ""});
    }
  } else if (suite == "paper") {
    const std::filesystem::path folder = std::filesystem::path(LUMINAV_SOURCE_DIR) / "launch/scenarios";
    for (const char* file : {"laboratory.toml", "laboratory-known.toml", "office.toml", "office-known.toml"}) {
      for (const char* mode : {"paper", "modern"}) {
        entries.push_back({folder / file, 1000, 1009, "rendered", false, suite, "", mode});
      }
    }
  } else if (suite == "scale") {
    for (const auto& file : make_scale_series(generated)) {
      entries.push_back({file, 1000, 1000, "geometric", false, suite, ""});
    }
  } else if (suite == "missions" || suite == "zones") {
    for (const auto& file : suite == "missions" ? make_missions(generated) : make_zone_missions(generated)) {
      const Scenario scenario = read_scenario(file);
      const std::string folder = scenario.building_file.parent_path().filename().string();
      // a mission with zones has a building of its own, named after the one it was made of
      entries.push_back({file, scenario.seed, scenario.seed, "geometric", false, suite,
                         suite + ", " + (suite == "zones" ? folder.substr(0, folder.rfind('-')) : folder)});
    }
  }
  return entries;
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
  return "quick, laboratory, office, localization, detector, luminaires, tolerance, mapping, navigation, endurance, "
         "missions, zones, jobs, worlds, scale, drawn, mishaps, paper, all";
}

bool has_detector_part(const std::string& suite) {
  return suite == "detector" || suite == "tolerance" || suite == "luminaires" || suite == "all";
}

std::vector<SuiteEntry> suite_entries(const std::string& suite, const std::filesystem::path& generated) {
  std::vector<SuiteEntry> entries;
  if (suite == "all") {
    for (const char* part : kAll) {
      for (SuiteEntry& entry : suite_entries(part, generated)) {
        // some are part of two suites: the laboratory is one of the worlds too
        const bool known = std::any_of(entries.begin(), entries.end(), [&](const SuiteEntry& other) {
          return other.scenario == entry.scenario && other.first_seed == entry.first_seed;
        });
        if (!known) {
          if (entry.suite == "worlds" || entry.suite == "drawn") {
            entry.last_seed = entry.first_seed + kWorldSeedsInAll - 1;
          }
          entries.push_back(std::move(entry));
        }
      }
    }
    return entries;
  }
  entries = named_entries(suite);
  // Absolute: scenarios below it name buildings there, and a relative name is read from the scenario's own folder.
  for (SuiteEntry& entry : made_entries(suite, std::filesystem::absolute(generated))) {
    entries.push_back(std::move(entry));
  }
  if (entries.empty() && !has_detector_part(suite)) {
    throw ConfigurationError(fmt::format("--suite {}: must be one of {}", suite, suite_names()));
  }
  return entries;
}

}  // namespace luminav
