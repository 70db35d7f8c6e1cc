#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/evaluation/detector_score/detector_suite.hpp"
#include "tests/evaluation/report/compare_reports.hpp"
#include "tests/evaluation/report/evaluation_report.hpp"
#include "tests/evaluation/report/html_report.hpp"
#include "tests/evaluation/report/output_file.hpp"
#include "tests/evaluation/report/report_part.hpp"
#include "tests/evaluation/report/report_runs.hpp"
#include "tests/evaluation/report/run_report.hpp"
#include "tests/evaluation/runs/evaluation_jobs.hpp"
#include "tests/evaluation/runs/suites.hpp"
#include "tests/evaluation/sensing/detector_behaviour.hpp"
#include "tests/evaluation/sensing/sensing_agreement.hpp"
#include "tests/evaluation/sensing/sensing_survey.hpp"

namespace luminav {
namespace {

constexpr double kHardlySeen = 0.1;  // share of the fixtures of a kind that a person sees: it is not visible

namespace fs = std::filesystem;

struct Request {
  std::string suite;
  std::vector<std::string> scenarios;
  JobOptions jobs;
  std::int64_t threads = 1;
  std::string json;
  std::string html;
  std::string compare;
  std::string fit_sensing;
  std::string generated;
  std::string check_sensing;
  std::string shard;
  std::string part;
  std::vector<std::string> merge;
};

/// Parts are reported of together: one alone says nothing of the whole, and the whole is not run again.
void check_parts(const Request& request) {
  const auto refuse = [](const char* flag, bool given, const char* why) {
    if (given) {
      throw ConfigurationError(fmt::format("{}: {}", flag, why));
    }
  };
  const bool sharded = !request.shard.empty();
  const bool merging = !request.merge.empty();
  refuse("--shard", sharded != !request.part.empty(), "needs --part FILE, and --part needs --shard");
  const char* const alone = "is for the whole, not for a part: give it with --merge";
  refuse("--json", sharded && !request.json.empty(), alone);
  refuse("--html", sharded && !request.html.empty(), alone);
  refuse("--compare", sharded && !request.compare.empty(), alone);
  refuse("--merge", merging && (sharded || !request.suite.empty() || !request.scenarios.empty()),
         "takes parts that were run: without --shard, --suite and --scenario");
  const char* const whole = "needs all runs on one machine, without --shard and --merge";
  refuse("--fit-sensing", (sharded || merging) && !request.fit_sensing.empty(), whole);
  refuse("--check-sensing", (sharded || merging) && !request.check_sensing.empty(), whole);
  if (sharded) {
    (void)read_shard(request.shard);
  }
}

void check(const Request& request) {
  const auto one_of = [](const char* flag, const std::string& value, const char* a, const char* b) {
    if (!value.empty() && value != a && value != b) {
      throw ConfigurationError(fmt::format("{} {}: must be {} or {}", flag, value, a, b));
    }
  };
  one_of("--mode", request.jobs.mode, "paper", "modern");
  one_of("--sensing", request.jobs.sensing, "rendered", "geometric");
  if (request.threads < 1 || request.threads > 256) {
    throw ConfigurationError(fmt::format("--jobs {}: must be between 1 and 256", request.threads));
  }
  check_parts(request);
  if (!request.suite.empty() && !request.scenarios.empty()) {
    throw ConfigurationError("--suite and --scenario: only one of them");
  }
  if (!request.check_sensing.empty() && request.jobs.sensing != "geometric") {
    throw ConfigurationError("--check-sensing: needs --sensing geometric");
  }
  if (!request.fit_sensing.empty() && request.jobs.sensing == "geometric") {
    throw ConfigurationError("--fit-sensing: only rendered runs can be measured");
  }
  for (const auto& [flag, file] :
       {std::pair("--compare", request.compare), {"--check-sensing", request.check_sensing}}) {
    if (!file.empty() && !fs::is_regular_file(file)) {
      throw ConfigurationError(fmt::format("{} {}: cannot be read, there is no such file", flag, file));
    }
  }
  check_writable("--json", request.json);
  check_writable("--html", request.html);
  check_writable("--fit-sensing", request.fit_sensing);
  check_writable("--part", request.part);
}

std::vector<SuiteEntry> entries_of(const Request& request) {
  std::vector<SuiteEntry> entries;
  for (const std::string& given : request.scenarios) {
    for (const fs::path& file : scenario_files(given)) {
      const std::uint64_t seed = read_scenario(file).seed;
      entries.push_back({file, seed, seed, "rendered", false, "", ""});
    }
  }
  return entries.empty() ? suite_entries(request.suite.empty() ? "quick" : request.suite, request.generated) : entries;
}

std::string behaviour_file(const Request& request) {
  return request.jobs.behaviour_file.empty() ? default_behaviour_file(request.jobs.mode).string()
                                             : request.jobs.behaviour_file;
}

std::string agreement_text(const DetectorBehaviour& behaviour) {
  return behaviour.agreement.empty()
             ? "Geometric sensing was not checked against rendered runs (--check-sensing): its figures may not be "
               "quoted.\n"
             : "Agreement measured for this sensing: " + behaviour.agreement;
}

void write_fit(const Request& request, const std::vector<EvaluationJob>& jobs,
               const std::vector<SensingSurveyResult>& surveys) {
  std::vector<std::string> names;
  for (const EvaluationJob& job : jobs) {
    if (names.empty() || names.back() != job.scenario.name) {
      names.push_back(job.scenario.name);
    }
  }
  std::string source = fmt::format("{} rendered runs:", jobs.size());
  for (const std::string& name : names) {
    source += " " + name;
  }
  const DetectorBehaviour behaviour =
      fit_behaviour(surveys, request.jobs.mode == "paper" ? request.jobs.mode : "modern", source);
  write_whole_file(request.fit_sensing, to_json(behaviour));
}

std::string sensing_name(const Request& request, const std::vector<SuiteEntry>& entries) {
  if (!request.jobs.sensing.empty()) {
    return request.jobs.sensing;
  }
  const bool any = needs_behaviour(entries, request.jobs);
  const bool all = any && std::all_of(entries.begin(), entries.end(),
                                      [](const SuiteEntry& entry) { return entry.sensing == "geometric"; });
  return all ? "geometric" : (any ? "mixed" : "rendered");
}

std::vector<DetectorCondition> measure_detector_part(const Request& request, const Shard& shard) {
  if (!request.scenarios.empty() || !has_detector_part(request.suite) || shard.index != 1) {
    return {};
  }
  const std::string& mode = request.jobs.mode;
  const int threads = static_cast<int>(request.threads);
  return request.suite == "tolerance"    ? measure_tolerance(threads)
         : request.suite == "luminaires" ? measure_luminaires(mode, threads)
                                         : measure_detector(mode, threads);
}

/// Runs what is asked for, or its shard. `rendered_report` not empty: geometric sensing is checked against it.
ReportPart measure(const Request& request, const std::string& rendered_report) {
  const std::vector<SuiteEntry> entries = entries_of(request);
  DetectorBehaviour behaviour;
  const bool geometric = needs_behaviour(entries, request.jobs);
  if (geometric) {
    behaviour = read_detector_behaviour(behaviour_file(request));
  }
  ReportPart part;
  part.shard = request.shard.empty() ? Shard{} : read_shard(request.shard);
  part.suite = !request.scenarios.empty() ? "custom" : (request.suite.empty() ? "quick" : request.suite);
  part.mode = request.jobs.mode.empty() ? "default" : request.jobs.mode;
  part.sensing = sensing_name(request, entries);
  const std::vector<EvaluationJob> all = jobs_of(entries, request.jobs, &behaviour);
  for (const EvaluationJob& job : all) {
    part.plan.push_back(fmt::format("{} seed {}", job.scenario.name, job.scenario.seed));
  }
  std::vector<EvaluationJob> jobs = runs_of_shard(all, part.shard);
  std::vector<SensingSurveyResult> surveys(jobs.size());
  for (std::size_t i = 0; i < jobs.size() && !request.fit_sensing.empty(); ++i) {
    jobs[i].options.survey = &surveys[i];
  }
  part.detector = measure_detector_part(request, part.shard);
  part.runs = run_jobs(jobs, static_cast<int>(request.threads));
  if (!rendered_report.empty()) {
    behaviour.agreement = to_text(compare_sensings(rendered_report, to_json(part)));
    write_whole_file(behaviour_file(request), to_json(behaviour));
  }
  if (!request.fit_sensing.empty()) {
    write_fit(request, jobs, surveys);
  }
  part.sensing_remark = geometric ? agreement_text(behaviour) : "";
  return part;
}

ReportPart merged(const std::vector<std::string>& files) {
  std::vector<std::pair<std::string, ReportPart>> parts;
  for (const std::string& file : files) {
    parts.emplace_back(file, part_of_cbor(read_whole_file(file), file));
  }
  return joined(parts);
}

/// Writes and prints the report; false when a run failed.
bool report(const Request& request, const ReportPart& whole, const std::string& old_report,
            std::chrono::steady_clock::time_point start) {
  std::size_t passed = 0;
  for (const RunReport& run : whole.runs) {
    fmt::print("{}", to_text(run));
    passed += run.passed ? 1 : 0;
  }
  const std::string all = to_json(whole);
  std::string remarks = whole.sensing_remark;
  if (!old_report.empty()) {
    remarks += to_text(compare_reports(old_report, all));
  }
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!request.html.empty()) {
    write_whole_file(request.html, html_report({all, remarks, wall}, whole.runs));
  }
  if (!request.json.empty()) {
    write_whole_file(request.json, all);  // last: where it is, the rest was written too
  }
  for (const DetectorCondition& c : whole.detector) {
    const std::string plain =
        c.plain < kHardlySeen ? "not visible"
                              : fmt::format("{:.4f} of the {:.0f} % that a person sees", c.plain_recall, 100 * c.plain);
    fmt::print(
        "detector, {:<27} {:>4} frames, precision {:.4f}, recall {:.4f} ({}), {:.1f} wrong per 100 frames, centre "
        "{:.3f} px, direction {:.4f} deg RMS\n",
        c.name, c.frames, c.precision, c.recall, plain, c.false_per_100_frames, c.centre_rms_px, c.orientation_rms_deg);
  }
  fmt::print("\n{}{}{}", scenario_table_text(whole.runs), summary_text(all), remarks);
  fmt::print("{}{:.0f} s\n", whole.runs.empty() ? "" : fmt::format("{} of {} runs passed, ", passed, whole.runs.size()),
             wall);
  for (const RunReport& run : whole.runs) {
    if (!run.passed) {
      fmt::print("failed: {}\n  again: {}\n", run.failure, run.reproduce);
    }
  }
  return passed == whole.runs.size();
}

int evaluate(const Request& request) {
  check(request);
  const auto start = std::chrono::steady_clock::now();
  const std::string old_report = request.compare.empty() ? "" : read_whole_file(request.compare);
  const std::string rendered_report = request.check_sensing.empty() ? "" : read_whole_file(request.check_sensing);
  if (!old_report.empty()) {
    (void)parts_of_report(old_report, "the old");  // refused now, and not when all has been driven
  }
  if (!rendered_report.empty()) {
    (void)runs_of_report(rendered_report, "the rendered");
    check_writable("--check-sensing: the sensing's table", behaviour_file(request));
  }
  const ReportPart part = request.merge.empty() ? measure(request, rendered_report) : merged(request.merge);
  if (!request.part.empty()) {
    write_whole_file(request.part, to_cbor(part));
    fmt::print("part {}/{}: {} of {} runs, in {}\n", part.shard.index, part.shard.count, part.runs.size(),
               part.plan.size(), request.part);
    return 0;  // whether they passed is the whole report's to say
  }
  return report(request, part, old_report, start) ? 0 : 1;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  luminav::Request request;
  request.generated = LUMINAV_BINARY_DIR "/generated-worlds";
  luminav::CommandLine line("evaluate",
                            "Runs scenarios in process and in simulated time and says how good the robot is.");
  line.text("--suite", request.suite, "one of " + luminav::suite_names() + "; default quick")
      .list("--scenario", request.scenarios, "scenario file or a folder of them, instead of a suite; several times")
      .text("--seeds", request.jobs.seeds, "A..B, instead of the suite's or the scenario's own")
      .text("--mode", request.jobs.mode,
            "paper | modern, for all nodes that have both; default as the robot's file says")
      .integer("--jobs", request.threads, "runs side by side")
      .text("--sensing", request.jobs.sensing,
            "rendered | geometric: detections are drawn from the detector's measured behaviour; default as the suite "
            "has it")
      .output_file("--json", request.json, "write all reports there")
      .output_file("--html", request.html, "write a page with pictures there")
      .text("--shard", request.shard, "I/N: only the I-th of N parts of the runs, for --merge; writes --part")
      .output_file("--part", request.part, "write the runs of --shard there")
      .list("--merge", request.merge, "the parts of all shards: reports as if all had been run here")
      .text("--compare", request.compare, "an older JSON report: says what got better or worse beyond noise")
      .text("--pictures", request.jobs.pictures, "folder for a picture of each run")
      .text("--logs", request.jobs.logs, "folder for an LCM log of each run")
      .flag("--patrol", request.jobs.patrol, "drive to the goals over and over until the scenario's duration is over")
      .flag("--trace", request.jobs.trace, "print a line for each simulated second")
      .flag("--mono8", request.jobs.mono8, "do not compress the pictures")
      .text("--behaviour", request.jobs.behaviour_file, "what geometric sensing draws from")
      .output_file("--fit-sensing", request.fit_sensing,
                   "measure the detector's behaviour in these rendered runs, write it there")
      .text(
          "--check-sensing", request.check_sensing,
          "a JSON report of the same runs rendered: says how well geometric ones agree and keeps it with the behaviour")
      .text("--generated", request.generated, "folder for the buildings that suites make");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("evaluate", [&] { return luminav::evaluate(request); });
}
