#include "tests/evaluation/run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

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
                     {"expected", g.expect_refused ? "refused" : "reached"},
                     {"error_m", rounded(g.error_m)},
                     {"heading_error_deg", rounded(g.heading_error_deg)},
                     {"time_s", rounded(g.time_s)},
                     {"shortest_m", rounded(g.shortest_m)},
                     {"cause", g.cause}});
  }
  ordered_json processes = ordered_json::array();
  for (const ProcessResult& p : r.processes) {
    processes.push_back({{"name", p.name},
                         {"cpu_percent", rounded(p.cpu_percent)},
                         {"rss_mb", rounded(p.rss_mb)},
                         {"restarts", p.restarts}});
  }
  ordered_json contacts = ordered_json::array();
  for (const ContactEvent& c : r.drive.contacts) {
    contacts.push_back({{"at_s", rounded(c.at_s)},
                        {"with", c.with},
                        {"x", rounded(c.x)},
                        {"y", rounded(c.y)},
                        {"theta_deg", rounded(c.theta_deg)},
                        {"linear", rounded(c.linear)},
                        {"angular", rounded(c.angular)},
                        {"control_state", c.control_state}});
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
          {"cpu_s", rounded(r.cpu_s)},
          {"worst_step_ms", rounded(r.worst_step_ms)},
          {"reproduce", r.reproduce},
          {"world", {{"hash", r.world_hash}, {"table", r.world_table}}},
          {"localized_s", r.localized ? ordered_json(rounded(r.localized_s)) : ordered_json(nullptr)},
          {"localized_after_m", r.localized ? ordered_json(rounded(r.localized_after_m)) : ordered_json(nullptr)},
          {"tracking_ratio", rounded(r.tracking_ratio)},
          {"ambiguous_ratio", rounded(r.ambiguous_ratio)},
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
          {"contact_events", contacts},
          {"oscillation_s", rounded(r.drive.oscillation_s)},
          {"corridor_share", rounded(r.drive.corridor_share)},
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

void put_contact_classes(const std::vector<RunReport>& runs, ordered_json& summary) {
  std::map<std::string, int> classes;
  for (const RunReport& run : runs) {
    for (const ContactEvent& contact : run.drive.contacts) {
      ++classes[contact.with];
    }
  }
  for (const auto& [with, count] : classes) {
    summary["contacts_" + with] = count;
  }
}

/// Missions that began while the pose was known, against 1.5 times the shortest way at full speed and 10 s.
void put_mission_figures(const std::vector<RunReport>& runs, ordered_json& summary) {
  constexpr double kSpeed = 0.5;  // [m/s]
  std::vector<double> times;
  std::vector<double> headings;
  std::vector<double> corridors;
  for (const RunReport& run : runs) {
    for (const GoalResult& goal : run.goals) {
      if (goal.reached && goal.shortest_m > 0.0) {
        times.push_back(goal.time_s / (1.5 * goal.shortest_m / kSpeed + 10.0));
      }
      if (goal.reached) {
        headings.push_back(goal.heading_error_deg);
      }
    }
    if (run.drive.corridor_share >= 0.0) {
      corridors.push_back(run.drive.corridor_share);
    }
  }
  if (!headings.empty()) {
    summary["goal_heading_p95_deg"] = rounded(quantile(headings, 0.95));
  }
  if (!times.empty()) {
    summary["mission_time_ratio_median"] = rounded(quantile(times, 0.5));
    summary["mission_time_ratio_p95"] = rounded(quantile(times, 0.95));
  }
  if (!corridors.empty()) {
    summary["corridor_share_median"] = rounded(quantile(corridors, 0.5));
  }
  summary["oscillating_runs"] =
      std::count_if(runs.begin(), runs.end(), [](const RunReport& r) { return r.drive.oscillation_s > 0.0; });
}

ordered_json summary_of(const std::vector<RunReport>& runs) {
  if (runs.empty()) {
    return {{"runs", 0}, {"passed", 0}};
  }
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
  std::int64_t refused_right = 0;
  std::int64_t to_refuse = 0;
  std::int64_t contacts = 0;
  std::int64_t carries = 0;
  std::int64_t noticed = 0;
  std::int64_t recovered = 0;
  double clearance = 10.0;
  double simulated = 0.0;
  double wall = 0.0;
  double cpu = 0.0;
  double worst_step = 0.0;
  for (const RunReport& run : runs) {
    if (run.localized) {
      distances.push_back(run.localized_after_m);
    }
    for (const GoalResult& goal : run.goals) {
      goals += goal.expect_refused ? 0 : 1;
      reached += goal.reached && !goal.expect_refused ? 1 : 0;
      to_refuse += goal.expect_refused ? 1 : 0;
      refused_right += goal.expect_refused && goal.refused ? 1 : 0;
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
    cpu += run.cpu_s;
    worst_step = std::max(worst_step, run.worst_step_ms);
  }
  const double n = std::max<double>(1.0, static_cast<double>(runs.size()));
  ordered_json summary = {{"runs", runs.size()},
                          {"passed", count([](const RunReport& r) { return r.passed; })},
                          {"localized_ratio", rounded(static_cast<double>(count(localized)) / n)}};
  summary["confident_wrong_runs"] = count([](const RunReport& r) { return r.confident_wrong_s > 0.0; });
  if (!distances.empty()) {
    const auto put_mean = [&](const char* key, const std::function<double(const RunReport&)>& value) {
      summary[key] = rounded(mean(value, localized));
    };
    summary["localized_after_m_median"] = rounded(quantile(distances, 0.5));
    summary["localized_after_m_p95"] = rounded(quantile(distances, 0.95));
    put_mean("tracking_ratio", [](const RunReport& r) { return r.tracking_ratio; });
    put_mean("in_view_position_rms_m", [](const RunReport& r) { return r.in_view_position_rms_m; });
    put_mean("in_view_heading_rms_deg", [](const RunReport& r) { return r.in_view_heading_rms_deg; });
    put_mean("mission_position_p95_m", [](const RunReport& r) { return r.mission_position_p95_m; });
    put_mean("mission_heading_p95_deg", [](const RunReport& r) { return r.mission_heading_p95_deg; });
    put_mean("nees", [](const RunReport& r) { return r.nees; });
  }
  if (carries > 0) {
    summary["carries"] = carries;
    summary["carries_noticed"] = noticed;
    summary["carries_recovered"] = recovered;
  }
  if (goals > 0) {
    summary["goals"] = goals;
    summary["goals_reached"] = reached;
    summary["goal_error_p95_m"] = rounded(quantile(goal_errors, 0.95));
  }
  if (to_refuse > 0) {
    summary["goals_to_refuse"] = to_refuse;
    summary["refused_right"] = refused_right;
  }
  summary["contacts"] = contacts;
  put_contact_classes(runs, summary);
  summary["min_clearance_m"] = rounded(clearance);
  const auto drove_freely = [](const RunReport& r) { return r.mean_speed_m_s > 0.0; };
  if (count(drove_freely) > 0) {
    summary["mean_speed_m_s"] = rounded(mean([](const RunReport& r) { return r.mean_speed_m_s; }, drove_freely));
  }
  put_mission_figures(runs, summary);
  const auto compared = [](const RunReport& r) { return r.path_efficiency > 0.0; };
  if (count(compared) > 0) {
    summary["path_efficiency"] = rounded(mean([](const RunReport& r) { return r.path_efficiency; }, compared));
  }
  const auto mapped = [](const RunReport& r) { return r.map.measured; };
  if (count(mapped) > 0) {
    summary["wall_median_m"] = rounded(mean([](const RunReport& r) { return r.map.wall_median_m; }, mapped));
    summary["wall_recall"] = rounded(mean([](const RunReport& r) { return r.map.wall_recall; }, mapped));
    summary["free_precision"] = rounded(mean([](const RunReport& r) { return r.map.free_precision; }, mapped));
  }
  // per core: CPU time where it was measured, so that other programs on the machine do not count
  summary["real_time_factor"] = rounded(cpu > 0.0 ? simulated / cpu : (wall > 0.0 ? simulated / wall : 0.0));
  if (cpu > 0.0) {
    summary["worst_step_ms"] = rounded(worst_step);
  }
  return summary;
}

/// Runs of each scenario, in the order in which they came.
std::vector<std::pair<std::string, std::vector<RunReport>>> by_scenario(const std::vector<RunReport>& runs) {
  std::vector<std::pair<std::string, std::vector<RunReport>>> groups;
  for (const RunReport& run : runs) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == run.scenario; });
    if (group == groups.end()) {
      group = groups.insert(group, {run.scenario, {}});
    }
    group->second.push_back(run);
  }
  return groups;
}

}  // namespace

std::string to_json(const RunReport& report, int indent) {
  return json_of(report).dump(indent) + "\n";
}

std::string to_json(const std::string& suite, const std::string& mode, const std::string& sensing,
                    const std::vector<RunReport>& runs, const std::vector<DetectorCondition>& detector) {
  ordered_json list = ordered_json::array();
  for (const RunReport& run : runs) {
    list.push_back(json_of(run));
  }
  ordered_json all = {
      {"suite", suite}, {"mode", mode}, {"sensing", sensing}, {"summary", summary_of(runs)}, {"runs", list}};
  const auto scenarios = by_scenario(runs);
  for (std::size_t i = 0; i < scenarios.size() && scenarios.size() > 1; ++i) {
    all["scenarios"][scenarios[i].first] = summary_of(scenarios[i].second);
  }
  if (!detector.empty()) {
    ordered_json conditions = ordered_json::array();
    for (const DetectorCondition& c : detector) {
      conditions.push_back({{"condition", c.name},
                            {"frames", c.frames},
                            {"precision", rounded(c.precision)},
                            {"recall", rounded(c.recall)},
                            {"centre_rms_px", rounded(c.centre_rms_px)},
                            {"orientation_rms_deg", rounded(c.orientation_rms_deg)},
                            {"milliseconds", rounded(c.milliseconds)}});
    }
    for (const char* key : {"precision", "recall", "centre_rms_px", "orientation_rms_deg"}) {
      all["summary"][key] = conditions.back()[key];
    }
    all["detector"] = conditions;
  }
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

std::string scenario_table_text(const std::vector<RunReport>& runs) {
  std::string text =
      fmt::format("{:<24} {:>9} {:>6} {:>8} {:>6} {:>7} {:>16} {:>16} {:>5} {:>9} {:>8} {:>6} {:>6} {:>6}\n",
                  "scenario", "passed", "found", "after m", "wrong", "track %", "RMS in view", "95 % of mission",
                  "NEES", "goals", "contacts", "m/s", "eff.", "x real");
  for (const auto& [name, of_scenario] : by_scenario(runs)) {
    const ordered_json s = summary_of(of_scenario);
    const auto get = [&](const char* key) { return s.value(key, 0.0); };
    text += fmt::format(
        "{:<24} {:>9} {:>6} {:>8.1f} {:>6.0f} {:>7.2f} {:>16} {:>16} {:>5.2f} {:>9} {:>8.0f} {:>6.2f} {:>6.2f} "
        "{:>6.0f}\n",
        name, fmt::format("{:.0f}/{:.0f}", get("passed"), get("runs")),
        fmt::format("{:.0f} %", 100.0 * get("localized_ratio")), get("localized_after_m_median"),
        get("confident_wrong_runs"), 100.0 * get("tracking_ratio"),
        fmt::format("{:.0f} mm {:.2f} deg", 1e3 * get("in_view_position_rms_m"), get("in_view_heading_rms_deg")),
        fmt::format("{:.0f} mm {:.2f} deg", 1e3 * get("mission_position_p95_m"), get("mission_heading_p95_deg")),
        get("nees"), fmt::format("{:.0f}/{:.0f}", get("goals_reached"), get("goals")), get("contacts"),
        get("mean_speed_m_s"), get("path_efficiency"), get("real_time_factor"));
  }
  return runs.empty() ? "" : text;
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
              : fmt::format("  never localized; AMBIGUOUS for {:.1f} % of the time\n", 100.0 * r.ambiguous_ratio);
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
  for (const ContactEvent& c : r.drive.contacts) {
    text += fmt::format(
        "  contact with {} after {:.1f} s at ({:.2f}, {:.2f}, {:.0f} deg), control state {}, {:.2f} m/s and {:.0f} "
        "deg/s\n",
        c.with, c.at_s, c.x, c.y, c.theta_deg, c.control_state, c.linear, degrees(c.angular));
  }
  if (r.drive.corridor_share >= 0.0 || r.drive.oscillation_s > 0.0) {
    text += fmt::format("  in corridors {:.0f} % of the clearance there is (median); steering to and fro {:.1f} s\n",
                        100.0 * std::max(0.0, r.drive.corridor_share), r.drive.oscillation_s);
  }
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
