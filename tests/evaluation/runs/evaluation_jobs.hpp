#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/evaluation/report/run_report.hpp"
#include "tests/evaluation/runs/scenario_run.hpp"
#include "tests/evaluation/runs/suites.hpp"

namespace luminav {

/// One run to do.
struct EvaluationJob {
  Scenario scenario;
  ScenarioRunOptions options;
  std::string reproduce;  // command that does it again
  std::string suite;
  std::string group;
};

struct JobOptions {
  std::string seeds;           // "A..B" instead of the entry's own; "" = those
  std::string mode;            // "paper", "modern" or "" = as the robot's file says
  std::string sensing;         // "rendered", "geometric" or "" = as the entry says
  std::string behaviour_file;  // what geometric sensing draws from; "" = the measured one of the mode
  bool patrol = false;         // also where the entry does not ask for it
  bool mono8 = false;          // pictures are not compressed
  bool trace = false;
  std::string pictures;  // folder; "" = none
  std::string logs;      // folder; "" = none
};

/// What geometric sensing draws from unless the user names another file.
std::filesystem::path default_behaviour_file(const std::string& mode);

/// All runs of the entries, by entry and seed. `behaviour` is what geometric sensing draws from. Throws
/// ConfigurationError for scenarios that cannot be read, or that have the same name: reports, pictures and logs are
/// told apart by it.
std::vector<EvaluationJob> jobs_of(const std::vector<SuiteEntry>& entries, const JobOptions& options,
                                   const DetectorBehaviour* behaviour);

/// True when one of the entries is run with geometric sensing.
bool needs_behaviour(const std::vector<SuiteEntry>& entries, const JobOptions& options);

/// Does all jobs on several threads, with a line of progress each on stderr; results are in the order of the jobs
/// whatever the number of threads. A run that throws has failed with that sentence.
std::vector<RunReport> run_jobs(const std::vector<EvaluationJob>& jobs, int threads);

}  // namespace luminav
