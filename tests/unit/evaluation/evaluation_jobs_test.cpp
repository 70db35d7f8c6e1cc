#include "tests/evaluation/runs/evaluation_jobs.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

const std::string kLaboratory = LUMINAV_SOURCE_DIR "/launch/scenarios/laboratory.toml";

TEST(EvaluationJobs, MakesOneForEachSeed) {
  JobOptions options;
  options.seeds = "5..7";
  const auto jobs = jobs_of({{kLaboratory, 1, 2, "rendered", false, "", ""}}, options, nullptr);
  ASSERT_EQ(jobs.size(), 3U);
  EXPECT_EQ(jobs[0].scenario.seed, 5U);
  EXPECT_EQ(jobs[2].scenario.seed, 7U);
}

TEST(EvaluationJobs, KeepsTheSuitesSeedsUnlessToldOtherwise) {
  EXPECT_EQ(jobs_of({{kLaboratory, 1, 4, "rendered", false, "", ""}}, {}, nullptr).size(), 4U);
}

TEST(EvaluationJobs, SaysTheCommandThatDoesItAgain) {
  JobOptions options;
  options.mode = "paper";
  const auto jobs = jobs_of({{kLaboratory, 3, 3, "geometric", true, "", ""}}, options, nullptr);
  EXPECT_EQ(jobs.at(0).reproduce, LUMINAV_SOURCE_DIR "/scripts/evaluate --scenario " + kLaboratory +
                                      " --seeds 3 --mode paper --sensing geometric --patrol");
}

TEST(EvaluationJobs, TellsTheModesOfASuiteApart) {
  std::vector<SuiteEntry> entries;
  for (const char* mode : {"paper", "modern"}) {
    entries.push_back({kLaboratory, 1000, 1000, "rendered", false, "paper", "", mode});
  }
  const auto jobs = jobs_of(entries, {}, nullptr);
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].scenario.name, "laboratory-paper");
  EXPECT_EQ(jobs[0].options.robot.mode, "paper");
  EXPECT_EQ(jobs[1].options.robot.mode, "modern");
  EXPECT_THAT(jobs[0].reproduce, testing::HasSubstr("--mode paper"));
  JobOptions options;
  options.mode = "modern";
  EXPECT_THROW(jobs_of(entries, options, nullptr), ConfigurationError);
}

TEST(EvaluationJobs, RefusesSeedsThatAreNone) {
  for (const char* seeds : {"", "7..3", "a..b", "1..", "..", "-3", "1..999999999", "3x"}) {
    JobOptions options;
    options.seeds = seeds;
    if (std::string(seeds).empty()) {
      continue;
    }
    EXPECT_THROW(jobs_of({{kLaboratory, 1, 1, "rendered", false, "", ""}}, options, nullptr), ConfigurationError)
        << seeds;
  }
}

TEST(EvaluationJobs, RefusesAStartInAWallBeforeAnythingRuns) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "start-in-a-wall.toml";
  for (const char* start : {"x = 0.05\ny = 0.05", "x = -50.0\ny = 3.0"}) {
    std::ofstream(file) << "building = \"" << LUMINAV_SOURCE_DIR << "/launch/buildings/laboratory/building.toml\"\n"
                        << "robot = \"" << LUMINAV_SOURCE_DIR << "/launch/robots/p3dx.toml\"\n[start]\n"
                        << start << "\ntheta = 0.0\n";
    EXPECT_THROW(jobs_of({{file, 1, 1, "rendered", false, "", ""}}, {}, nullptr), ConfigurationError) << start;
  }
}

std::string refusal_of(const std::vector<SuiteEntry>& entries, const JobOptions& options = {}) {
  try {
    jobs_of(entries, options, nullptr);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

TEST(EvaluationJobs, RefusesScenariosOfTheSameNameBecauseTheirRunsCouldNotBeToldApart) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "other-folder";
  std::filesystem::create_directories(folder);
  const std::filesystem::path other = folder / "laboratory.toml";
  std::ofstream(other) << "building = \"" << LUMINAV_SOURCE_DIR << "/launch/buildings/laboratory/building.toml\"\n"
                       << "robot = \"" << LUMINAV_SOURCE_DIR << "/launch/robots/p3dx.toml\"\n";
  const SuiteEntry here{kLaboratory, 1, 2, "rendered", false, "", ""};
  EXPECT_THAT(refusal_of({here, {other, 5, 6, "rendered", false, "", ""}}),
              testing::AllOf(testing::HasSubstr(kLaboratory), testing::HasSubstr(other.string())));
  EXPECT_THAT(refusal_of({here, {kLaboratory, 2, 3, "geometric", false, "", ""}}), testing::HasSubstr("seed 2"));
  EXPECT_EQ(refusal_of({here, {kLaboratory, 3, 4, "rendered", false, "", ""}}), "");
  JobOptions five;
  five.seeds = "5";
  EXPECT_THAT(refusal_of({here, {kLaboratory, 3, 4, "rendered", false, "", ""}}, five), testing::HasSubstr("seed 5"));
}

TEST(EvaluationJobs, TellsAllRunsOfEverySuiteApart) {
  const std::filesystem::path generated = std::filesystem::path(testing::TempDir()) / "generated-worlds";
  for (const char* suite : {"laboratory", "navigation", "all"}) {
    EXPECT_EQ(refusal_of(suite_entries(suite, generated)), "") << suite;
  }
}

TEST(EvaluationJobs, ReportsARunThatThrowsAsFailed) {
  auto jobs = jobs_of({{kLaboratory, 1, 1, "rendered", false, "", ""}}, {}, nullptr);
  jobs[0].scenario.start = Pose2{-50.0, -50.0, 0.0};
  const auto reports = run_jobs(jobs, 1);
  ASSERT_EQ(reports.size(), 1U);
  EXPECT_FALSE(reports[0].passed);
  EXPECT_THAT(reports[0].failure, testing::HasSubstr("start"));
}

}  // namespace
}  // namespace luminav
