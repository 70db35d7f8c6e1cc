#include "tests/evaluation/runs/evaluation_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <map>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>
#include <tuple>
#include <utility>

#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "tests/evaluation/judge/start_resolvability.hpp"

namespace luminav {
namespace {

std::pair<std::uint64_t, std::uint64_t> parse_seeds(const std::string& text) {
  const std::size_t dots = text.find("..");
  try {
    std::size_t used = 0;
    const std::string first_text = text.substr(0, dots);
    const std::uint64_t first = std::stoull(first_text, &used);
    bool whole = used == first_text.size() && first_text[0] != '-';
    std::uint64_t last = first;
    if (dots != std::string::npos) {
      const std::string last_text = text.substr(dots + 2);
      last = std::stoull(last_text, &used);
      whole = whole && used == last_text.size() && last_text[0] != '-';
    }
    if (whole && last >= first && last - first < 100'000) {
      return {first, last};
    }
  } catch (const std::exception&) {
    // said below
  }
  throw ConfigurationError(fmt::format("--seeds {}: must be A..B with A <= B, or one number", text));
}

/// For a shell: quoted when it holds anything but harmless characters.
std::string shell_word(const std::string& word) {
  const bool harmless = std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '/' || c == '.' || c == '-' || c == '_' || c == '+';
  });
  if (harmless && !word.empty()) {
    return word;
  }
  std::string quoted = "'";
  for (const char c : word) {
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + "'";
}

const std::string& sensing_of(const SuiteEntry& entry, const JobOptions& options) {
  return options.sensing.empty() ? entry.sensing : options.sensing;
}

std::string reproduce_command(const SuiteEntry& entry, std::uint64_t seed, const JobOptions& options) {
  std::string command = fmt::format(
      "{} --scenario {} --seeds {}", (std::filesystem::path(LUMINAV_SOURCE_DIR) / "scripts/evaluate").string(),
      shell_word(std::filesystem::absolute(entry.scenario).lexically_normal().string()), seed);
  if (const std::string& mode = entry.mode.empty() ? options.mode : entry.mode; !mode.empty()) {
    command += " --mode " + mode;
  }
  if (sensing_of(entry, options) != "rendered") {
    command += " --sensing " + sensing_of(entry, options);
    if (!options.behaviour_file.empty()) {
      command += " --behaviour " + shell_word(std::filesystem::absolute(options.behaviour_file).string());
    }
  }
  if (entry.patrol || options.patrol) {
    command += " --patrol";
  }
  if (options.mono8) {
    command += " --mono8";
  }
  return command;
}

/// Reports, pictures and logs are told apart by the scenario's name and the seed.
void check_names(const std::vector<EvaluationJob>& jobs) {
  std::map<std::string, std::filesystem::path> files;  // by the scenario's name
  std::set<std::pair<std::string, std::uint64_t>> runs;
  for (const EvaluationJob& job : jobs) {
    const std::filesystem::path file = std::filesystem::weakly_canonical(job.scenario.file);
    const auto [known, is_new] = files.emplace(job.scenario.name, file);
    if (!is_new && known->second != file) {
      throw ConfigurationError(
          fmt::format("scenarios {} and {}: are both called {}, runs could not be told apart, rename one of them",
                      known->second.string(), file.string(), job.scenario.name));
    }
    if (!runs.emplace(job.scenario.name, job.scenario.seed).second) {
      throw ConfigurationError(
          fmt::format("scenario {}: seed {} is asked for twice", file.string(), job.scenario.seed));
    }
  }
}

std::string duration_text(double seconds) {
  return seconds < 100.0 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60.0);
}

}  // namespace

std::filesystem::path default_behaviour_file(const std::string& mode) {
  return std::filesystem::path(LUMINAV_SOURCE_DIR) /
         fmt::format("tests/evaluation/behaviour-{}.json", mode == "paper" ? "paper" : "modern");
}

bool needs_behaviour(const std::vector<SuiteEntry>& entries, const JobOptions& options) {
  return std::any_of(entries.begin(), entries.end(),
                     [&](const SuiteEntry& entry) { return sensing_of(entry, options) == "geometric"; });
}

std::vector<EvaluationJob> jobs_of(const std::vector<SuiteEntry>& entries, const JobOptions& options,
                                   const DetectorBehaviour* behaviour) {
  std::vector<EvaluationJob> jobs;
  for (const SuiteEntry& entry : entries) {
    if (!entry.mode.empty() && (!options.mode.empty() || sensing_of(entry, options) == "geometric")) {
      throw ConfigurationError("--suite " + entry.suite +
                               ": compares both modes on rendered pictures, without --mode and --sensing geometric");
    }
    const Scenario scenario = read_scenario(entry.scenario);
    auto [first, last] = std::pair{entry.first_seed, entry.last_seed};
    if (!options.seeds.empty()) {
      std::tie(first, last) = parse_seeds(options.seeds);
    }
    Scenario drawn = scenario;
    drawn.seed = first;
    // said now rather than after hours: an impossible start, an unknown fixture
    (void)draw_world(drawn, read_building(scenario.true_building_file), read_robot(scenario.robot_file));
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      EvaluationJob job{scenario, {}, reproduce_command(entry, seed, options), entry.suite, entry.group};
      job.scenario.seed = seed;
      job.scenario.name += entry.mode.empty() ? "" : "-" + entry.mode;
      job.options.robot = {entry.mode.empty() ? options.mode : entry.mode, !options.mono8,
                           sensing_of(entry, options) == "geometric" ? behaviour : nullptr};
      job.options.trace = options.trace;
      job.options.patrol = entry.patrol || options.patrol;
      const std::string name = fmt::format("{}-{}", job.scenario.name, seed);
      for (const auto& [folder, target, extension] : {std::tuple{&options.pictures, &job.options.picture_file, ".png"},
                                                      {&options.logs, &job.options.log_file, ".lcm"}}) {
        if (!folder->empty()) {
          std::filesystem::create_directories(*folder);
          *target = (std::filesystem::path(*folder) / (name + extension)).string();
        }
      }
      jobs.push_back(std::move(job));
    }
  }
  check_names(jobs);
  return jobs;
}

std::vector<RunReport> run_jobs(const std::vector<EvaluationJob>& jobs, int threads) {
  std::vector<RunReport> reports(jobs.size());
  std::atomic<std::size_t> next = 0;
  double expected = 0.0;  // [s] simulated at most, as a measure of the work
  for (const EvaluationJob& job : jobs) {
    expected += job.scenario.duration;
  }
  std::size_t done = 0;
  double work_done = 0.0;
  std::mutex mutex;
  StartResolvability resolvability;
  const auto start = std::chrono::steady_clock::now();
  // the longest first, so that no worker is left alone with one of them in the end
  std::vector<std::size_t> order(jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return jobs[a].scenario.duration > jobs[b].scenario.duration; });
  const auto work = [&] {
    for (std::size_t turn = next++; turn < jobs.size(); turn = next++) {
      const std::size_t i = order[turn];
      const EvaluationJob& job = jobs[i];
      RunReport report;
      try {
        report = run_scenario(job.scenario, job.options);
        if (!report.trail.empty()) {
          report.resolvable_after_m = resolvability.distance(job.scenario.building_file, job.scenario.robot_file,
                                                             report.trail.front().truth.position());
        }
      } catch (const std::exception& error) {
        report.scenario = job.scenario.name;
        report.seed = job.scenario.seed;
        report.failure = error.what();
      }
      report.scenario_file = job.scenario.file.string();
      report.reproduce = job.reproduce;
      report.suite = job.suite;
      report.group = job.group.empty() ? report.scenario : job.group;
      const std::lock_guard lock(mutex);
      ++done;
      work_done += job.scenario.duration;
      const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const double left = spent * (expected - work_done) / work_done;
      fmt::print(stderr, "[{}/{}] {} seed {}: {}{}\n", done, jobs.size(), report.scenario, report.seed,
                 report.passed ? "passed" : "FAILED, " + report.failure,
                 done < jobs.size() ? fmt::format(" (about {} left)", duration_text(left)) : "");
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

}  // namespace luminav
