#include "tests/evaluation/report/evaluation_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/evaluation/report/run_summary.hpp"

namespace luminav {

using nlohmann::ordered_json;

std::string to_json(const std::string& suite, const std::string& mode, const std::string& sensing,
                    const std::vector<RunReport>& runs, const std::vector<DetectorCondition>& detector) {
  ordered_json list = ordered_json::array();
  for (const RunReport& run : runs) {
    list.push_back(json_of(run));
  }
  ordered_json all = {{"suite", suite},
                      {"mode", mode},
                      {"sensing", sensing},
                      {"summary", summary_of(pointers_to(runs))},
                      {"runs", list}};
  for (const auto& [key, groups] : {std::pair("suites", suites_of(runs)), {"scenarios", groups_of(runs)}}) {
    for (std::size_t i = 0; i < groups.size() && groups.size() > 1; ++i) {
      all[key][groups[i].name] = summary_of(groups[i].runs);
    }
  }
  if (!detector.empty()) {
    ordered_json conditions = ordered_json::array();
    for (const DetectorCondition& c : detector) {
      conditions.push_back({{"condition", c.name},
                            {"frames", c.frames},
                            {"precision", rounded(c.precision)},
                            {"recall", rounded(c.recall)},
                            {"plain", rounded(c.plain)},
                            {"plain_recall", rounded(c.plain_recall)},
                            {"false_per_100_frames", rounded(c.false_per_100_frames)},
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
  const std::vector<RunGroup> rows = rows_of(runs);
  const bool any_suite = std::any_of(rows.begin(), rows.end(), [](const RunGroup& row) { return row.is_suite(); });
  for (const RunGroup& row : rows) {
    const ordered_json s = summary_of(row.runs);
    const auto get = [&](const char* key) { return s.value(key, 0.0); };
    const auto cell = [&](const char* key, double factor, int digits) {
      return s.contains(key) ? fmt::format("{:.{}f}", factor * get(key), digits) : std::string("-");
    };
    const auto errors = [&](const char* position, const char* heading) {
      return s.contains(position) ? cell(position, 1e3, 0) + " mm " + cell(heading, 1.0, 2) + " deg" : std::string("-");
    };
    text += fmt::format(
        "{:<24} {:>9} {:>6} {:>8} {:>6.0f} {:>7} {:>16} {:>16} {:>5} {:>9} {:>8.0f} {:>6} {:>6} "
        "{:>6.0f}\n",
        (any_suite && !row.is_suite() ? "  " : "") + row.name, fmt::format("{:.0f}/{:.0f}", get("passed"), get("runs")),
        fmt::format("{:.0f} %", 100.0 * get("localized_ratio")), cell("localized_after_m_median", 1.0, 1),
        get("confident_wrong_runs"), cell("tracking_ratio", 100.0, 2),
        errors("in_view_position_rms_m", "in_view_heading_rms_deg"),
        errors("mission_position_p95_m", "mission_heading_p95_deg"), cell("nees", 1.0, 2),
        fmt::format("{:.0f}/{:.0f}", get("goals_reached"), get("goals")), get("contacts"),
        cell("mean_speed_m_s", 1.0, 2), cell("path_efficiency", 1.0, 2), get("real_time_factor"));
  }
  return runs.empty() ? "" : text;
}

}  // namespace luminav
