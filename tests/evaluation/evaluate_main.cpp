#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/evaluation/run_report.hpp"
#include "tests/evaluation/scenario_run.hpp"
#include "tests/evaluation/suites.hpp"

namespace luminav {
namespace {

struct Job {
  Scenario scenario;
  ScenarioRunOptions options;
};

/// Runs all jobs on several threads; results are in the order of the jobs whatever the number of threads.
std::vector<RunReport> run_all(const std::vector<Job>& jobs, int threads) {
  std::vector<RunReport> reports(jobs.size());
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::size_t passed = 0;
  std::mutex mutex;
  const auto start = std::chrono::steady_clock::now();
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size(); i = next++) {
      RunReport report;
      try {
        report = run_scenario(jobs[i].scenario, jobs[i].options);
      } catch (const std::exception& error) {
        report.scenario = jobs[i].scenario.name;
        report.seed = jobs[i].scenario.seed;
        report.failure = error.what();
      }
      const std::lock_guard lock(mutex);
      ++done;
      passed += report.passed ? 1 : 0;
      const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      fmt::print(stderr, "[{}/{}] {} seed {}: {} ({:.0f} s left)\n", done, jobs.size(), report.scenario, report.seed,
                 report.passed ? "passed" : "FAILED, " + report.failure,
                 spent / static_cast<double>(done) * static_cast<double>(jobs.size() - done));
      reports[i] = std::move(report);
    }
  };
  std::vector<std::thread> workers;
  for (int i = 1; i < threads; ++i) {
    workers.emplace_back(work);
  }
  work();
  for (std::thread& worker : workers) {
    worker.join();
  }
  return reports;
}

std::pair<std::uint64_t, std::uint64_t> parse_seeds(const std::string& text) {
  const std::size_t dots = text.find("..");
  try {
    const std::uint64_t first = std::stoull(text.substr(0, dots));
    const std::uint64_t last = dots == std::string::npos ? first : std::stoull(text.substr(dots + 2));
    if (last >= first && last - first < 100'000) {
      return {first, last};
    }
  } catch (const std::exception&) {
  }
  throw ConfigurationError(fmt::format("--seeds {}: must be A..B with A <= B", text));
}

std::vector<std::filesystem::path> scenario_files(const std::vector<std::string>& given) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : given) {
    if (!std::filesystem::is_directory(name)) {
      files.emplace_back(name);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(name)) {
      if (entry.path().extension() == ".toml") {
        files.push_back(entry.path());
      }
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

int evaluate(int argc, char** argv) {
  std::string suite;
  std::vector<std::string> scenarios;
  std::string seeds;
  std::string mode;
  std::int64_t threads = 1;
  std::string json;
  std::string pictures;
  std::string logs;
  bool trace = false;
  bool mono8 = false;
  CommandLine line("evaluate", "Runs scenarios in process and in simulated time and says how good the robot is.");
  line.text("--suite", suite, fmt::format("one of {}", suite_names()))
      .list("--scenario", scenarios, "scenario file or a folder of them; may be given several times")
      .text("--seeds", seeds, "A..B, instead of the suite's or the scenario's own")
      .text("--mode", mode, "paper | modern, for all nodes that have both; default as the robot's file says")
      .integer("--jobs", threads, "runs side by side")
      .text("--json", json, "write all reports there")
      .text("--pictures", pictures, "folder for a picture of each run")
      .text("--logs", logs, "folder for an LCM log of each run")
      .flag("--trace", trace, "print a line for each simulated second")
      .flag("--mono8", mono8, "do not compress the pictures");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (!mode.empty() && mode != "paper" && mode != "modern") {
    throw ConfigurationError(fmt::format("--mode {}: must be paper or modern", mode));
  }
  if (threads < 1 || threads > 256) {
    throw ConfigurationError("--jobs: must be between 1 and 256");
  }
  std::vector<SuiteEntry> entries;
  for (const std::filesystem::path& file : scenario_files(scenarios)) {
    const std::uint64_t seed = read_scenario(file).seed;
    entries.push_back({file, seed, seed});
  }
  if (entries.empty()) {
    entries = suite_entries(suite.empty() ? "quick" : suite);
  }
  std::vector<Job> jobs;
  for (SuiteEntry& entry : entries) {
    if (!seeds.empty()) {
      std::tie(entry.first_seed, entry.last_seed) = parse_seeds(seeds);
    }
    for (std::uint64_t seed = entry.first_seed; seed <= entry.last_seed; ++seed) {
      Job job{read_scenario(entry.scenario), {}};
      job.scenario.seed = seed;
      job.options.robot = {mode, mode, mode, !mono8};
      job.options.trace = trace;
      const std::string name = fmt::format("{}-{}", job.scenario.name, seed);
      for (const auto& [folder, target, extension] :
           {std::tuple{&pictures, &job.options.picture_file, ".png"}, {&logs, &job.options.log_file, ".lcm"}}) {
        if (!folder->empty()) {
          std::filesystem::create_directories(*folder);
          *target = (std::filesystem::path(*folder) / (name + extension)).string();
        }
      }
      jobs.push_back(std::move(job));
    }
  }
  const std::vector<RunReport> reports = run_all(jobs, static_cast<int>(threads));
  std::size_t passed = 0;
  for (const RunReport& report : reports) {
    fmt::print("{}", to_text(report));
    passed += report.passed ? 1 : 0;
  }
  const std::string all =
      to_json(suite.empty() ? "custom" : suite, mode.empty() ? "default" : mode, "rendered", reports);
  if (!json.empty()) {
    write_text_file(json, all);
  }
  fmt::print("{}\n{} of {} runs passed\n", summary_text(all), passed, reports.size());
  return passed == reports.size() ? 0 : 1;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("evaluate", [&] { return luminav::evaluate(argc, argv); });
}
