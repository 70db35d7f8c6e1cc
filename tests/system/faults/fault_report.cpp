#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/system/faults/fault.hpp"

namespace luminav {
namespace {

struct Row {
  int count = 0, bridged = 0, contacts = 0, late_stand = 0, late_resume = 0;
  int violated = 0;
  std::vector<double> stood, over_bound, back, resumed;  // [s]

  void add(const FaultResult& result) {
    ++count;
    bridged += result.bridged ? 1 : 0;
    contacts += result.contacts;
    late_stand += result.stands_in_time() ? 0 : 1;
    late_resume += result.resumes_in_time() ? 0 : 1;
    violated += result.violated || !result.is_said_in_time() ? 1 : 0;
    if (result.stood) {
      stood.push_back(*result.stood);
    }
    if (result.must_stand && result.stood && !result.bridged) {
      over_bound.push_back(*result.stood - result.bound);
    }
    if (result.back) {
      back.push_back(*result.back);
    }
    if (result.resumed && !result.needs_no_resume) {
      resumed.push_back(*result.resumed);
    }
  }
  [[nodiscard]] std::string wrong() const {
    return (late_stand + late_resume > 0 ? fmt::format("  {} too late to stand, {} to go on", late_stand, late_resume)
                                         : "") +
           (violated > 0 ? fmt::format("  {} not said or not kept", violated) : "");
  }
};

std::string middle_and_worst(std::vector<double> values) {
  if (values.empty()) {
    return "-";
  }
  std::sort(values.begin(), values.end());
  return fmt::format("{:.2f} / {:.2f}", values[values.size() / 2], values.back());
}

template <typename Value>
nlohmann::json or_null(const std::optional<Value>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace

std::string to_table(const std::vector<FaultResult>& results, const GoalTally& goals) {
  std::map<std::string, Row> rows;
  int contacts = 0;
  int blind_contacts = 0;
  for (const FaultResult& result : results) {
    contacts += result.contacts;
    blind_contacts += result.blind_contacts;
    rows[to_string(result.fault)].add(result);
  }
  std::string text =
      fmt::format("{:<22} {:>5} {:>7} {:>13} {:>15} {:>13} {:>13} {:>8}\n", "fault (median / worst, s)", "times",
                  "bridged", "stands after", "beyond bound", "ready after", "moves after", "contacts");
  for (const auto& [name, row] : rows) {
    text += fmt::format("{:<25} {:>5} {:>7} {:>13} {:>15} {:>13} {:>13} {:>8}{}\n", name, row.count, row.bridged,
                        middle_and_worst(row.stood), middle_and_worst(row.over_bound), middle_and_worst(row.back),
                        middle_and_worst(row.resumed), row.contacts, row.wrong());
  }
  text += fmt::format("{} faults, {} goals reached, {} missed, {} contacts between faults, {} in faults",
                      results.size(), goals.reached, goals.missed, goals.contacts_between_faults, contacts);
  text += blind_contacts > 0
              ? fmt::format(", {} of these with the robot's line cut and before its watchdog\n", blind_contacts)
              : std::string("\n");
  for (const std::string& cause : goals.causes) {
    text += "  missed: " + cause + "\n";
  }
  return text;
}

std::string to_json(const std::vector<FaultResult>& results, const GoalTally& goals, std::uint64_t seed,
                    double minutes) {
  nlohmann::json faults = nlohmann::json::array();
  for (const FaultResult& result : results) {
    faults.push_back({{"fault", to_string(result.fault)},
                      {"round", result.round},
                      {"at_s", result.at},
                      {"duration_s", result.fault.duration},
                      {"linear_m_s", result.linear},
                      {"angular_rad_s", result.angular},
                      {"must_stand", result.must_stand},
                      {"bound_s", result.bound},
                      {"stood_s", or_null(result.stood)},
                      {"bridged_s", or_null(result.bridged)},
                      {"ready_s", or_null(result.back)},
                      {"moved_after_ready_s", or_null(result.resumed)},
                      {"said_s", or_null(result.said)},
                      {"sentence", result.sentence},
                      {"way_m", result.way},
                      {"needs_no_resume", result.needs_no_resume},
                      {"contacts", result.contacts},
                      {"blind_contacts", result.blind_contacts},
                      {"longest_gap_in_truth_s", result.truth_gap},
                      {"ok", result.good()},
                      {"remark", result.remark}});
  }
  const nlohmann::json report = {{"seed", seed},
                                 {"minutes", minutes},
                                 {"passed", passed(results, goals)},
                                 {"goals_reached", goals.reached},
                                 {"goals_missed", goals.causes},
                                 {"contacts_between_faults", goals.contacts_between_faults},
                                 {"faults", faults}};
  return report.dump(1) + "\n";
}

}  // namespace luminav
