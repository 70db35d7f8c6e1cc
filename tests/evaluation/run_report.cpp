#include "tests/evaluation/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace luminav {
namespace {

using nlohmann::ordered_json;

/// Four significant decimals are more than any figure here is worth.
double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

ordered_json json_of(const RunReport& r) {
  ordered_json goals = ordered_json::array();
  for (const GoalResult& g : r.goals) {
    goals.push_back({{"x", rounded(g.x)},
                     {"y", rounded(g.y)},
                     {"reached", g.reached},
                     {"refused", g.refused},
                     {"error_m", rounded(g.error_m)},
                     {"heading_error_deg", rounded(g.heading_error_deg)},
                     {"time_s", rounded(g.time_s)},
                     {"cause", g.cause}});
  }
  ordered_json processes = ordered_json::array();
  for (const ProcessResult& p : r.processes) {
    processes.push_back({{"name", p.name},
                         {"cpu_percent", rounded(p.cpu_percent)},
                         {"rss_mb", rounded(p.rss_mb)},
                         {"restarts", p.restarts}});
  }
  ordered_json map = nullptr;
  if (r.map.measured) {
    map = {{"wall_median_m", rounded(r.map.wall_median_m)},
           {"wall_recall", rounded(r.map.wall_recall)},
           {"free_precision", rounded(r.map.free_precision)}};
  }
  return {{"scenario", r.scenario},
          {"seed", r.seed},
          {"passed", r.passed},
          {"failure", r.failure},
          {"simulated_s", rounded(r.simulated_s)},
          {"wall_s", rounded(r.wall_s)},
          {"world", {{"hash", r.world_hash}, {"table", r.world_table}}},
          {"localized_s", r.localized ? ordered_json(rounded(r.localized_s)) : ordered_json(nullptr)},
          {"localized_after_m", r.localized ? ordered_json(rounded(r.localized_after_m)) : ordered_json(nullptr)},
          {"tracking_ratio", rounded(r.tracking_ratio)},
          {"confident_wrong_s", rounded(r.confident_wrong_s)},
          {"in_view_position_rms_m", rounded(r.in_view_position_rms_m)},
          {"in_view_heading_rms_deg", rounded(r.in_view_heading_rms_deg)},
          {"mission_position_p95_m", rounded(r.mission_position_p95_m)},
          {"mission_heading_p95_deg", rounded(r.mission_heading_p95_deg)},
          {"nees", rounded(r.nees)},
          {"mean_speed_m_s", rounded(r.mean_speed_m_s)},
          {"path_efficiency", rounded(r.path_efficiency)},
          {"driven_m", rounded(r.driven_m)},
          {"goals", goals},
          {"contacts", r.contacts},
          {"hard_contacts", r.hard_contacts},
          {"min_clearance_m", rounded(r.min_clearance_m)},
          {"carries", r.carries},
          {"carries_noticed", r.carries_noticed},
          {"carries_recovered", r.carries_recovered},
          {"map", map},
          {"processes", processes}};
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

ordered_json summary_of(const std::vector<RunReport>& runs) {
  const auto count = [&](const std::function<bool(const RunReport&)>& claim) {
    return std::count_if(runs.begin(), runs.end(), claim);
  };
  const auto mean = [&](const std::function<double(const RunReport&)>& value,
                        const std::function<bool(const RunReport&)>& claim) {
    double sum = 0.0;
    int n = 0;
    for (const RunReport& run : runs) {
      if (claim(run)) {
        sum += value(run);
        ++n;
      }
    }
    return n == 0 ? 0.0 : sum / n;
  };
  const auto localized = [](const RunReport& r) { return r.localized; };
  std::vector<double> distances;
  std::vector<double> goal_errors;
  std::int64_t goals = 0;
  std::int64_t reached = 0;
  std::int64_t contacts = 0;
  std::int64_t carries = 0;
  std::int64_t noticed = 0;
  std::int64_t recovered = 0;
  double clearance = 10.0;
  double simulated = 0.0;
  double wall = 0.0;
  for (const RunReport& run : runs) {
    if (run.localized) {
      distances.push_back(run.localized_after_m);
    }
    for (const GoalResult& goal : run.goals) {
      ++goals;
      reached += goal.reached ? 1 : 0;
      if (goal.reached) {
        goal_errors.push_back(goal.error_m);
      }
    }
    contacts += run.contacts;
    carries += run.carries;
    noticed += run.carries_noticed;
    recovered += run.carries_recovered;
    clearance = std::min(clearance, run.min_clearance_m);
    simulated += run.simulated_s;
    wall += run.wall_s;
  }
  const double n = std::max<double>(1.0, static_cast<double>(runs.size()));
  ordered_json summary = {
      {"runs", runs.size()},
      {"passed", count([](const RunReport& r) { return r.passed; })},
      {"localized_ratio", rounded(static_cast<double>(count(localized)) / n)},
      {"localized_after_m_median", rounded(quantile(distances, 0.5))},
      {"localized_after_m_p95", rounded(quantile(distances, 0.95))},
      {"confident_wrong_runs", count([](const RunReport& r) { return r.confident_wrong_s > 0.0; })},
      {"tracking_ratio", rounded(mean([](const RunReport& r) { return r.tracking_ratio; }, localized))},
      {"in_view_position_rms_m", rounded(mean([](const RunReport& r) { return r.in_view_position_rms_m; }, localized))},
      {"in_view_heading_rms_deg",
       rounded(mean([](const RunReport& r) { return r.in_view_heading_rms_deg; }, localized))},
      {"mission_position_p95_m", rounded(mean([](const RunReport& r) { return r.mission_position_p95_m; }, localized))},
      {"mission_heading_p95_deg",
       rounded(mean([](const RunReport& r) { return r.mission_heading_p95_deg; }, localized))},
      {"nees", rounded(mean([](const RunReport& r) { return r.nees; }, localized))},
      {"carries", carries},
      {"carries_noticed", noticed},
      {"carries_recovered", recovered},
      {"goals", goals},
      {"goals_reached", reached},
      {"contacts", contacts},
      {"min_clearance_m", rounded(clearance)},
      {"goal_error_p95_m", rounded(quantile(goal_errors, 0.95))},
      {"mean_speed_m_s", rounded(mean([](const RunReport& r) { return r.mean_speed_m_s; },
                                      [](const RunReport& r) { return r.mean_speed_m_s > 0.0; }))},
      {"path_efficiency", rounded(mean([](const RunReport& r) { return r.path_efficiency; },
                                       [](const RunReport& r) { return r.path_efficiency > 0.0; }))}};
  const auto mapped = [](const RunReport& r) { return r.map.measured; };
  if (count(mapped) > 0) {
    summary["wall_median_m"] = rounded(mean([](const RunReport& r) { return r.map.wall_median_m; }, mapped));
    summary["wall_recall"] = rounded(mean([](const RunReport& r) { return r.map.wall_recall; }, mapped));
    summary["free_precision"] = rounded(mean([](const RunReport& r) { return r.map.free_precision; }, mapped));
  }
  summary["real_time_factor"] = rounded(wall > 0.0 ? simulated / wall : 0.0);
  return summary;
}

}  // namespace

std::string to_json(const RunReport& report, int indent) {
  return json_of(report).dump(indent) + "\n";
}

std::string to_json(const std::string& suite, const std::string& mode, const std::string& sensing,
                    const std::vector<RunReport>& runs) {
  ordered_json list = ordered_json::array();
  for (const RunReport& run : runs) {
    list.push_back(json_of(run));
  }
  const ordered_json all = {
      {"suite", suite}, {"mode", mode}, {"sensing", sensing}, {"summary", summary_of(runs)}, {"runs", list}};
  return all.dump(2) + "\n";
}

std::string summary_text(const std::string& json) {
  std::string text;
  const ordered_json all = ordered_json::parse(json);
  for (const auto& [key, value] : all["summary"].items()) {
    text += fmt::format("  {:<28} {}\n", key, value.dump());
  }
  return text;
}

std::string to_text(const RunReport& r) {
  std::string text = fmt::format("{} seed {}: {}{}\n", r.scenario, r.seed, r.passed ? "passed" : "FAILED",
                                 r.passed ? "" : ", " + r.failure);
  text += fmt::format("  simulated {:.0f} s in {:.0f} s, driven {:.1f} m, world {}\n", r.simulated_s, r.wall_s,
                      r.driven_m, r.world_hash);
  text += r.localized
              ? fmt::format(
                    "  localized after {:.1f} s and {:.1f} m; tracking {:.1f} % since; confidently wrong {:.1f} s\n",
                    r.localized_s, r.localized_after_m, 100.0 * r.tracking_ratio, r.confident_wrong_s)
              : "  never localized\n";
  text += fmt::format(
      "  pose error: in view {:.3f} m, {:.2f} deg RMS; 95 % of the mission {:.3f} m, {:.2f} deg; NEES {:.2f}\n",
      r.in_view_position_rms_m, r.in_view_heading_rms_deg, r.mission_position_p95_m, r.mission_heading_p95_deg, r.nees);
  for (std::size_t i = 0; i < r.goals.size(); ++i) {
    const GoalResult& g = r.goals[i];
    text += fmt::format("  goal {} ({:.2f}, {:.2f}): {} after {:.0f} s, {:.3f} m and {:.1f} deg off{}\n", i + 1, g.x,
                        g.y, g.reached ? "reached" : (g.refused ? "refused" : "missed"), g.time_s, g.error_m,
                        g.heading_error_deg, g.cause.empty() ? "" : ": " + g.cause);
  }
  text += fmt::format(
      "  contacts {}, with things sonar hardly sees {}; smallest clearance {:.2f} m; {:.2f} m/s on free stretches; "
      "path efficiency {:.2f}\n",
      r.contacts, r.hard_contacts, r.min_clearance_m, r.mean_speed_m_s, r.path_efficiency);
  if (r.carries > 0) {
    text += fmt::format("  carried {} times, noticed {}, recovered {}\n", r.carries, r.carries_noticed,
                        r.carries_recovered);
  }
  if (r.map.measured) {
    text += fmt::format("  map: walls {:.3f} m off (median), recall {:.1f} %, free precision {:.1f} %\n",
                        r.map.wall_median_m, 100.0 * r.map.wall_recall, 100.0 * r.map.free_precision);
  }
  for (const ProcessResult& p : r.processes) {
    text += fmt::format("  {:<11} {:5.1f} % of a core, {:5.1f} MB, {} restarts\n", p.name, p.cpu_percent, p.rss_mb,
                        p.restarts);
  }
  return text;
}

void write_text_file(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".tmp";
  {
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.flush();
    if (!out) {
      throw std::runtime_error(fmt::format("{}: cannot be written", path));
    }
  }
  std::filesystem::rename(temporary, path);
}

}  // namespace luminav
