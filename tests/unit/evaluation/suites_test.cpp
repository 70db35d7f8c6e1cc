#include "tests/evaluation/runs/suites.hpp"

#include <gmock/gmock.h>

#include <map>
#include <set>
#include <utility>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

std::filesystem::path generated() {
  return std::filesystem::path(testing::TempDir()) / "generated-worlds";
}

TEST(Suites, HoldScenariosThatCanBeRead) {
  for (const char* suite : {"quick", "laboratory", "office", "localization", "mapping", "navigation", "endurance",
                            "jobs", "worlds", "drawn", "mishaps"}) {
    const auto entries = suite_entries(suite, generated());
    EXPECT_FALSE(entries.empty()) << suite;
    for (const SuiteEntry& entry : entries) {
      EXPECT_NO_THROW((void)read_scenario(entry.scenario)) << entry.scenario;
      EXPECT_LE(entry.first_seed, entry.last_seed);
    }
  }
}

TEST(Suites, LuminairesAreTheDetectorsAlone) {
  EXPECT_TRUE(has_detector_part("luminaires"));
  EXPECT_TRUE(suite_entries("luminaires", generated()).empty());
}

TEST(Suites, MeasureOnSeedsThatNobodyTunesOn) {
  for (const SuiteEntry& entry : suite_entries("worlds", generated())) {
    EXPECT_GE(entry.first_seed, 1000U);
    EXPECT_EQ(entry.last_seed - entry.first_seed, 19U);
  }
}

TEST(Suites, EnduranceIsTenHoursOfPatrol) {
  const auto entries = suite_entries("endurance", generated());
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_TRUE(entries[0].patrol);
  EXPECT_EQ(read_scenario(entries[0].scenario).duration, 36'000.0);
}

TEST(Suites, JobsAreSixtyInSevenHours) {
  for (const SuiteEntry& entry : suite_entries("jobs", generated())) {
    const Scenario scenario = read_scenario(entry.scenario);
    EXPECT_EQ(entry.last_seed - entry.first_seed, 9U);
    EXPECT_EQ(scenario.jobs.time, 25'200.0);
    EXPECT_EQ(scenario.jobs.count, 60);
    EXPECT_TRUE(scenario.dock.has_value());
  }
}

TEST(Suites, MissionsAreFiveHundredGoalsSomeBehindAClosedDoor) {
  std::size_t goals = 0;
  int to_refuse = 0;
  int with_people = 0;
  for (const SuiteEntry& entry : suite_entries("missions", generated())) {
    const Scenario scenario = read_scenario(entry.scenario);
    EXPECT_EQ(entry.sensing, "geometric");
    EXPECT_GE(entry.first_seed, 1000U);
    EXPECT_TRUE(scenario.start_known);
    goals += scenario.goals.size();
    with_people += scenario.people.empty() ? 0 : 1;
    for (const ScenarioGoal& goal : scenario.goals) {
      to_refuse += goal.expect_refused ? 1 : 0;
    }
  }
  EXPECT_EQ(goals, 500U);
  EXPECT_EQ(with_people, 75);
  EXPECT_GT(to_refuse, 3);
  EXPECT_LT(to_refuse, 50);
}

TEST(Suites, MayBeMadeInARelativeFolder) {
  const auto entries = suite_entries("missions", std::filesystem::relative(generated() / "relative"));
  ASSERT_FALSE(entries.empty());
  EXPECT_NO_THROW((void)read_scenario(entries.front().scenario));
}

TEST(Suites, ZonesAreTwoHundredMissionsWithFiveZonesEach) {
  int to_refuse = 0;
  int carried = 0;
  const std::vector<SuiteEntry> entries = suite_entries("zones", generated());
  EXPECT_EQ(entries.size(), 200U);
  for (const SuiteEntry& entry : entries) {
    const Scenario scenario = read_scenario(entry.scenario);
    EXPECT_EQ(read_building(scenario.building_file).zones.size(), 5U);
    EXPECT_EQ(scenario.goals.size(), 2U);
    for (const ScenarioGoal& goal : scenario.goals) {
      to_refuse += goal.expect_refused ? 1 : 0;
    }
    carried += static_cast<int>(scenario.events.size());
  }
  EXPECT_GT(to_refuse, 10);
  EXPECT_LT(to_refuse, 120);
  EXPECT_EQ(carried, 25);
}

TEST(Suites, WorldsAreTheEightOfThem) {
  const auto entries = suite_entries("worlds", generated());
  std::set<std::string> names;
  for (const SuiteEntry& entry : entries) {
    names.insert(entry.scenario.stem());
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("laboratory", "symmetric-corridor", "w3-dense", "w4-sparse",
                                                   "w5-panels", "w6-mixed", "w7-high", "w8-low"));
}

TEST(Suites, AllTakesPartOfEachAndNoRunTwice) {
  std::map<std::string, std::uint64_t> runs;
  std::set<std::pair<std::string, std::uint64_t>> once;
  for (const SuiteEntry& entry : suite_entries("all", generated())) {
    for (std::uint64_t seed = entry.first_seed; seed <= entry.last_seed; ++seed) {
      EXPECT_TRUE(once.emplace(entry.scenario, seed).second) << entry.scenario << " " << seed;
      ++runs[entry.suite];
    }
  }
  const std::map<std::string, std::uint64_t> expected = {
      {"localization", 30}, {"mapping", 7}, {"navigation", 40}, {"endurance", 1}, {"missions", 100},
      {"zones", 200},       {"worlds", 24}, {"scale", 5},       {"drawn", 32},    {"mishaps", 80}};
  EXPECT_EQ(runs, expected);
}

TEST(Suites, AnUnknownOneNamesThoseThereAre) {
  try {
    (void)suite_entries("nonsense", generated());
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("endurance, missions, zones, jobs, worlds, scale, drawn, mishaps, paper, all"));
  }
}

}  // namespace
}  // namespace luminav
