#include "tests/evaluation/report/run_report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace luminav {
namespace {

using nlohmann::ordered_json;

ordered_json or_null(const std::optional<double>& value) {
  return value ? ordered_json(rounded(*value)) : ordered_json(nullptr);
}

ordered_json json_of(const std::vector<GoalResult>& goals) {
  ordered_json list = ordered_json::array();
  for (const GoalResult& g : goals) {
    list.push_back({{"x", rounded(g.x)},
                    {"y", rounded(g.y)},
                    {"reached", g.reached},
                    {"refused", g.refused},
                    {"expected", g.expect_refused ? "refused" : "reached"},
                    {"error_m", rounded(g.error_m)},
                    {"heading_error_deg", or_null(g.heading_error_deg)},
                    {"time_s", rounded(g.time_s)},
                    {"shortest_m", rounded(g.shortest_m)},
                    {"cause", g.cause}});
  }
  return list;
}

ordered_json json_of(const std::vector<ProcessResult>& processes) {
  ordered_json list = ordered_json::array();
  for (const ProcessResult& p : processes) {
    list.push_back({{"name", p.name},
                    {"cpu_percent", rounded(p.cpu_percent)},
                    {"rss_mb", rounded(p.rss_mb)},
                    {"restarts", p.restarts}});
  }
  return list;
}

ordered_json json_of(const std::vector<ContactEvent>& contacts) {
  ordered_json list = ordered_json::array();
  for (const ContactEvent& c : contacts) {
    list.push_back({{"at_s", rounded(c.at_s)},
                    {"with", c.with},
                    {"x", rounded(c.x)},
                    {"y", rounded(c.y)},
                    {"theta_deg", rounded(c.theta_deg)},
                    {"linear", rounded(c.linear)},
                    {"angular", rounded(c.angular)},
                    {"control_state", c.control_state}});
  }
  return list;
}

ordered_json json_of(const MapResult& map) {
  if (!map.measured) {
    return nullptr;
  }
  return {{"wall_median_m", rounded(map.wall_median_m)},
          {"wall_recall", rounded(map.wall_recall)},
          {"free_precision", rounded(map.free_precision)},
          {"explored", rounded(map.explored)}};
}

ordered_json json_of(const std::optional<ZoneResult>& zones) {
  if (!zones) {
    return nullptr;
  }
  return {{"keep_out_m", rounded(zones->keep_out_m)},         {"leaving_s", rounded(zones->leaving_s)},
          {"over_speed_m_s", rounded(zones->over_speed_m_s)}, {"against_m", rounded(zones->against_m)},
          {"path_ratio", rounded(zones->path_ratio)},         {"path_m", rounded(zones->path_m)}};
}

ordered_json json_of(const std::optional<JobsResult>& jobs) {
  if (!jobs) {
    return nullptr;
  }
  return {{"jobs", jobs->jobs},
          {"right", jobs->right},
          {"lost", jobs->lost},
          {"doubled", jobs->doubled},
          {"answers", jobs->answers},
          {"guides_left", jobs->guides_left},
          {"returns", jobs->returns},
          {"homes", jobs->homes},
          {"charging", jobs->charging},
          {"charger_tries", jobs->charger_tries},
          {"min_voltage", rounded(jobs->min_voltage)},
          {"kills", jobs->kills},
          {"wrong", jobs->wrong}};
}

}  // namespace

double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

ordered_json json_of(const RunReport& r) {
  return {{"scenario", r.scenario},
          {"seed", r.seed},
          {"suite", r.suite},
          {"group", r.group.empty() ? r.scenario : r.group},
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
          {"resolvable_after_m", std::isfinite(r.resolvable_after_m) && r.resolvable_after_m >= 0.0
                                     ? ordered_json(rounded(r.resolvable_after_m))
                                     : ordered_json(nullptr)},
          {"tracking_ratio", rounded(r.tracking_ratio)},
          {"ambiguous_ratio", rounded(r.ambiguous_ratio)},
          {"confident_wrong_s", rounded(r.confident_wrong_s)},
          {"in_view_position_rms_m", or_null(r.in_view_position_rms_m)},
          {"in_view_heading_rms_deg", or_null(r.in_view_heading_rms_deg)},
          {"mission_position_p95_m", or_null(r.mission_position_p95_m)},
          {"mission_heading_p95_deg", or_null(r.mission_heading_p95_deg)},
          {"nees", or_null(r.nees)},
          {"mean_speed_m_s", rounded(r.mean_speed_m_s)},
          {"path_efficiency", rounded(r.path_efficiency)},
          {"driven_m", rounded(r.driven_m)},
          {"goals", json_of(r.goals)},
          {"contacts", r.contacts},
          {"hard_contacts", r.hard_contacts},
          {"contact_events", json_of(r.drive.contacts)},
          {"oscillation_s", rounded(r.drive.oscillation_s)},
          {"corridor_share", rounded(r.drive.corridor_share)},
          {"min_clearance_m", rounded(r.min_clearance_m)},
          {"carries", r.carries},
          {"carries_noticed", r.carries_noticed},
          {"carries_recovered", r.carries_recovered},
          {"map", json_of(r.map)},
          {"zones", json_of(r.zones)},
          {"jobs", json_of(r.jobs)},
          {"processes", json_of(r.processes)}};
}

std::string to_json(const RunReport& report) {
  return json_of(report).dump(2) + "\n";
}

}  // namespace luminav
