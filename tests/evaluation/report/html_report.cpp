#include "tests/evaluation/report/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "drivers/simulator/world/scenario.hpp"
#include "tests/evaluation/report/html_drawing.hpp"
#include "tests/evaluation/report/run_summary.hpp"

namespace luminav {
namespace {

using nlohmann::ordered_json;

constexpr int kDrawnPassed = 2;  // runs of a scenario that passed
constexpr int kDrawnFailed = 25;

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--paper:#f7f7f4;--card:#fff;--ink:#1d2328;--soft:#6a747d;--line:#dfe2e0;--good:#1f7a4d;
--bad:#c0392b;--blue:#1f6fd0;--green:#3b9a3b;--magenta:#b43fb4;--truth:#8d969e;--lamp:#f2b632;--box:#b07a48}
@media (prefers-color-scheme:dark){:root{--paper:#14181b;--card:#1d2226;--ink:#e4e8ea;--soft:#97a2aa;--line:#323a40;
--good:#58c48d;--bad:#ff7b6b;--blue:#63a8ff;--green:#6fcf6f;--magenta:#e07be0;--truth:#7d868e;--lamp:#c9962a;
--box:#c9996b}}
*{box-sizing:border-box} body{margin:0;background:var(--paper);color:var(--ink);
font:15px/1.5 system-ui,"Segoe UI",Roboto,"Helvetica Neue",sans-serif}
main{max-width:1360px;margin:0 auto;padding:28px 20px 60px} h1{font-size:25px;margin:0 0 2px;letter-spacing:-.01em}
h2{font-size:18px;margin:38px 0 10px} .soft{color:var(--soft)} .good{color:var(--good)} .bad{color:var(--bad)}
.tiles{display:grid;grid-template-columns:repeat(auto-fill,minmax(182px,1fr));gap:10px;margin:20px 0}
.tile{background:var(--card);border:1px solid var(--line);border-radius:9px;padding:10px 13px}
.tile b{display:block;font-size:19px;font-weight:620;font-variant-numeric:tabular-nums;white-space:nowrap} .tile span{color:var(--soft);
font-size:12.5px}
.wide{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:9px}
table{border-collapse:collapse;width:100%;font-size:13px;font-variant-numeric:tabular-nums}
th,td{padding:7px 8px;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap;vertical-align:top}
tr:last-child td{border-bottom:0} tr.suite td{font-weight:620;
border-top:2px solid var(--line)} tr.part td:first-child{padding-left:22px} th{color:var(--soft);font-weight:560} th:first-child,td:first-child,td.text
{text-align:left} td.text{white-space:normal;min-width:16em}
code,pre{font:12.5px/1.5 ui-monospace,"Cascadia Mono",Menlo,Consolas,monospace} code{user-select:all}
pre{margin:8px 0 0;padding:10px;background:var(--paper);border:1px solid var(--line);border-radius:6px;overflow:auto;
max-height:320px;white-space:pre-wrap;text-align:left}
.runs{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,560px),1fr));gap:14px}
.run{background:var(--card);border:1px solid var(--line);border-radius:9px;padding:12px 14px} .run h3{margin:0 0 8px;
font-size:15px;display:flex;justify-content:space-between;gap:12px} .run p{margin:6px 0 0;font-size:13px} .run p.why{margin:0 0 8px}
svg{display:block;width:100%;height:auto} svg.way{max-height:430px} svg.error{margin-top:10px}
path{fill:none;vector-effect:non-scaling-stroke;stroke-linejoin:round} .truth{stroke:var(--truth);stroke-width:4.5;
opacity:.75} .odometry{stroke:var(--magenta);stroke-width:1} .tracking{stroke:var(--blue);stroke-width:1.8}
.guessing{stroke:var(--green);stroke-width:1.6} .guess{fill:var(--green)} .lamp{fill:var(--lamp);opacity:.85}
.box{fill:var(--box)} .contact{stroke:var(--bad);stroke-width:3} circle.start{fill:var(--truth)} circle.goal{fill:none;stroke:var(--good);stroke-width:2;
vector-effect:non-scaling-stroke} circle.missed{stroke:var(--bad)} text{fill:var(--ink);font-family:inherit}
text.goal{fill:var(--good);font-weight:650} text.missed{fill:var(--bad)} text.axis{font-size:10.5px;fill:var(--soft)}
.grid{stroke:var(--line)} .bound{stroke:var(--bad);stroke-dasharray:4 4;opacity:.7}
.key{display:flex;flex-wrap:wrap;gap:16px;font-size:13px;color:var(--soft);margin:0 0 12px} .key i{display:inline-block;
width:20px;height:4px;border-radius:2px;margin-right:6px;vertical-align:middle}
)";

std::string number(double value, const char* unit, int digits) {
  return fmt::format("{:.{}f}{}", value, digits, unit);
}

std::string tile(const std::string& value, const std::string& name, const char* style = "") {
  return fmt::format("<div class=\"tile\"><b class=\"{}\">{}</b><span>{}</span></div>", style, value, name);
}

std::string tiles(const ordered_json& s) {
  std::string html = "<div class=\"tiles\">";
  const auto get = [&](const char* key) { return s.value(key, 0.0); };
  const auto text = [&](const char* key, double factor, const char* unit, int digits) {
    return s.contains(key) ? number(factor * get(key), unit, digits) : std::string("–");
  };
  const double runs = get("runs");
  if (runs > 0) {
    html += tile(fmt::format("{:.0f} of {:.0f}", get("passed"), runs), "runs passed",
                 get("passed") == runs ? "good" : "bad");
    html += tile(number(get("confident_wrong_runs"), "", 0), "runs confidently wrong",
                 get("confident_wrong_runs") == 0.0 ? "good" : "bad");
    html += tile(number(100.0 * get("localized_ratio"), " %", 1), "found out where they are");
    html += tile(text("localized_after_m_median", 1.0, " m", 2) + " / " + text("localized_after_m_p95", 1.0, " m", 1),
                 "driven until then, median / 95 %");
    html += tile(text("tracking_ratio", 100.0, " %", 2), "of the time TRACKING since");
    html +=
        tile(text("in_view_position_rms_m", 1000.0, " mm", 0) + " / " + text("in_view_heading_rms_deg", 1.0, "°", 2),
             "RMS error, fixture in view");
    html +=
        tile(text("mission_position_p95_m", 1000.0, " mm", 0) + " / " + text("mission_heading_p95_deg", 1.0, "°", 2),
             "95 % of the mission");
    html += tile(text("nees", 1.0, "", 2), "error² / covariance, 1 is right");
  }
  if (s.contains("carries")) {
    html +=
        tile(fmt::format("{:.0f} / {:.0f} of {:.0f}", get("carries_noticed"), get("carries_recovered"), get("carries")),
             "carries noticed / recovered");
  }
  if (s.contains("goals")) {
    html += tile(fmt::format("{:.0f} of {:.0f}", get("goals_reached"), get("goals")), "goals reached");
    html += tile(text("goal_error_p95_m", 100.0, " cm", 0), "off the goal, 95 %");
  }
  if (s.contains("refused_right")) {
    html += tile(fmt::format("{:.0f} of {:.0f}", get("refused_right"), get("goals_to_refuse")), "rightly refused");
  }
  if (runs > 0) {
    html += tile(number(get("contacts"), "", 0), "contacts", get("contacts") == 0.0 ? "good" : "bad");
    html += tile(number(get("min_clearance_m"), " m", 2), "smallest clearance");
  }
  if (s.contains("mean_speed_m_s")) {
    html += tile(number(get("mean_speed_m_s"), " m/s", 2), "on free stretches");
  }
  if (s.contains("path_efficiency")) {
    html += tile(number(get("path_efficiency"), "", 2), "shortest way / driven way");
  }
  if (s.contains("wall_median_m")) {
    html += tile(number(100.0 * get("wall_median_m"), " cm", 1), "walls off, median");
    html += tile(number(100.0 * get("wall_recall"), " %", 0) + " / " + number(100.0 * get("free_precision"), " %", 1),
                 "walls found / free is free");
    html += tile(number(100.0 * get("explored"), " %", 0), "of the floor explored");
  }
  if (s.contains("precision")) {
    html += tile(number(100.0 * get("precision"), " %", 1) + " / " + number(100.0 * get("recall"), " %", 1),
                 "detector's precision / recall");
    html += tile(number(get("centre_rms_px"), " px", 2) + " / " + number(get("orientation_rms_deg"), "°", 3),
                 "detector's centre / direction, RMS");
  }
  if (runs > 0) {
    html += tile(number(get("real_time_factor"), " x", 0), "real time, per core");
  }
  return html + "</div>";
}

std::string scenario_table(const std::vector<RunReport>& runs) {
  std::string html =
      "<h2>Scenarios</h2><div class=\"wide\"><table><tr><th>scenario<th>passed<th>localized<th>after, "
      "median<th>wrong<th>TRACKING<th>RMS in view<th>95 % of "
      "mission<th>NEES<th>goals<th>contacts<th>speed<th>efficiency<th>real "
      "time";
  const std::vector<RunGroup> rows = rows_of(runs);
  const bool any_suite = std::any_of(rows.begin(), rows.end(), [](const RunGroup& row) { return row.is_suite(); });
  for (const RunGroup& row : rows) {
    const ordered_json s = summary_of(row.runs);
    const auto cell = [&](const char* key, double factor, int digits, const char* unit) {
      return s.contains(key) ? number(factor * s.value(key, 0.0), unit, digits) : std::string("–");
    };
    const auto both = [&](const std::string& a, const std::string& b, const char* between) {
      return a == "–" ? a : a + between + b;
    };
    html += fmt::format("<tr{}><td>{}<td class=\"{}\">{}",
                        row.is_suite() ? " class=\"suite\"" : (any_suite ? " class=\"part\"" : ""),
                        html_escape(row.name), s.value("passed", 0) == s.value("runs", 0) ? "good" : "bad",
                        both(cell("passed", 1, 0, ""), cell("runs", 1, 0, ""), " of "));
    for (const std::string& text :
         {cell("localized_ratio", 100, 0, " %"), cell("localized_after_m_median", 1, 1, " m"),
          cell("confident_wrong_runs", 1, 0, ""), cell("tracking_ratio", 100, 1, " %"),
          both(cell("in_view_position_rms_m", 1000, 0, " mm"), cell("in_view_heading_rms_deg", 1, 2, "°"), ", "),
          both(cell("mission_position_p95_m", 1000, 0, " mm"), cell("mission_heading_p95_deg", 1, 2, "°"), ", "),
          cell("nees", 1, 2, ""), both(cell("goals_reached", 1, 0, ""), cell("goals", 1, 0, ""), " of "),
          cell("contacts", 1, 0, ""), cell("mean_speed_m_s", 1, 2, " m/s"), cell("path_efficiency", 1, 2, ""),
          cell("real_time_factor", 1, 0, " x")}) {
      html += "<td>" + text;
    }
  }
  return html + "</table></div>";
}

std::string failure_table(const std::vector<RunReport>& runs) {
  std::string rows;
  for (const RunReport& run : runs) {
    if (run.passed) {
      continue;
    }
    std::string log;
    for (const std::string& line : run.log) {
      log += html_escape(line) + "\n";
    }
    rows += fmt::format(
        "<tr><td>{}<td>{}<td class=\"text bad\">{}<td class=\"text\"><code>{}</code>{}", html_escape(run.scenario),
        run.seed, html_escape(run.failure), html_escape(run.reproduce),
        log.empty() ? "" : fmt::format("<details><summary class=\"soft\">log</summary><pre>{}</pre></details>", log));
  }
  return rows.empty()
             ? ""
             : "<h2>Failures</h2><div class=\"wide\"><table><tr><th>scenario<th>seed<th style=\"text-align:left\">"
               "why<th style=\"text-align:left\">run it again" +
                   rows + "</table></div>";
}

std::string detector_table(const ordered_json& conditions) {
  std::string html =
      "<h2>Detector</h2><div class=\"wide\"><table><tr><th>scene<th>frames<th>precision<th>recall<th>wrong in "
      "100<th>centre "
      "RMS<th>direction "
      "RMS<th>per frame";
  for (const auto& c : conditions) {
    html +=
        fmt::format("<tr><td>{}<td>{}<td>{:.2f} %<td>{:.1f} %<td>{:.1f}<td>{:.3f} px<td>{:.3f}°<td>{:.2f} ms",
                    html_escape(c.value("condition", "")), c.value("frames", 0), 100.0 * c.value("precision", 0.0),
                    100.0 * c.value("recall", 0.0), c.value("false_per_100_frames", 0.0), c.value("centre_rms_px", 0.0),
                    c.value("orientation_rms_deg", 0.0), c.value("milliseconds", 0.0));
  }
  return html + "</table></div>";
}

std::string card(const RunReport& run, const std::string& map_id) {
  std::string goals;
  for (std::size_t i = 0; i < std::min<std::size_t>(run.goals.size(), 12); ++i) {
    const GoalResult& goal = run.goals[i];
    goals += fmt::format("{}goal {} {} after {:.0f} s", i == 0 ? "" : "; ", i + 1,
                         goal.reached ? fmt::format("reached, {:.0f} cm off,", 100.0 * goal.error_m)
                                      : (goal.refused ? "refused" : "missed"),
                         goal.time_s);
  }
  return fmt::format(
      "<div class=\"run\"><h3><span>{} <span class=\"soft\">seed {}</span></span><span "
      "class=\"{}\">{}</span></h3>{}{}{}"
      "<p class=\"soft\">{} {:.0f} s, {:.0f} m; {}</p></div>",
      html_escape(run.scenario), run.seed, run.passed ? "good" : "bad", run.passed ? "passed" : "failed",
      run.passed ? "" : "<p class=\"bad why\">" + html_escape(run.failure) + "</p>", trajectory_svg(run, map_id),
      error_svg(run),
      run.localized ? fmt::format("localized after {:.1f} s and {:.1f} m;", run.localized_s, run.localized_after_m)
                    : "never localized;",
      run.simulated_s, run.driven_m, html_escape(goals));
}

std::string run_cards(const std::vector<RunReport>& runs) {
  std::map<std::string, std::string> map_ids;  // by building
  std::map<std::string, int> drawn;
  int failed = 0;
  std::string symbols;
  std::string cards;
  for (const bool passed : {false, true}) {
    for (const RunReport& run : runs) {
      if (run.passed != passed || run.trail.empty() ||
          (passed ? drawn[run.suite + "/" + run.group]++ >= kDrawnPassed : failed++ >= kDrawnFailed)) {
        continue;
      }
      const std::string building =
          run.scenario_file.empty() ? "" : read_scenario(run.scenario_file).building_file.string();
      if (map_ids.count(building) == 0) {
        const std::string id = fmt::format("map{}", map_ids.size());
        map_ids[building] = id;
        symbols += map_symbol(run, id);
      }
      cards += card(run, map_ids[building]);
    }
  }
  return cards.empty() ? ""
                       : fmt::format(
                             "<h2>Runs</h2><div class=\"key\"><span><i style=\"background:var(--truth)\"></i>true "
                             "way</span><span><i "
                             "style=\"background:var(--blue)\"></i>believed while TRACKING</span><span><i "
                             "style=\"background:var(--green)\"></i>guessed before</span><span><i "
                             "style=\"background:var(--magenta)\"></i>odometry alone</span><span><i "
                             "style=\"background:var(--lamp)\"></i>fixtures as believed</span><span><i "
                             "style=\"background:var(--box)\"></i>boxes the map does not know</span><span><i "
                             "style=\"background:var(--bad)\"></i>contacts</span></div><svg width=\"0\" "
                             "height=\"0\" style=\"position:absolute\">{}</svg><div class=\"runs\">{}</div>",
                             symbols, cards);
}

}  // namespace

std::string html_report(const HtmlReportInput& input, const std::vector<RunReport>& runs) {
  const ordered_json all = ordered_json::parse(input.json);
  const std::string title = fmt::format("Evaluation: {}", all.value("suite", ""));
  std::string world;
  for (const RunReport& run : runs) {
    if (!run.world_table.empty()) {
      world = fmt::format(
          "<h2>The world around the robot's beliefs</h2><details><summary class=\"soft\">spread of the truth and what "
          "was "
          "drawn, {} seed {}, hash {}</summary><pre>{}</pre></details>",
          html_escape(run.scenario), run.seed, run.world_hash, html_escape(run.world_table));
      break;
    }
  }
  return fmt::format(
             "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
             "content=\"width=device-width,initial-scale=1\"><title>{}</title><style>{}</style><main><h1>{}</h1><div "
             "class=\"soft\">mode {}, sensing {}, {} runs in {:.0f} s</div>",
             html_escape(title), kStyle, html_escape(title), html_escape(all.value("mode", "")),
             html_escape(all.value("sensing", "")), runs.size(), input.wall_s) +
         tiles(all["summary"]) + (input.remarks.empty() ? "" : "<pre>" + html_escape(input.remarks) + "</pre>") +
         (runs.empty() ? "" : scenario_table(runs)) + failure_table(runs) +
         (all.contains("detector") ? detector_table(all["detector"]) : "") + run_cards(runs) + world +
         "</main></html>\n";
}

}  // namespace luminav
