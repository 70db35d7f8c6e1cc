#include "tests/evaluation/report/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace luminav {
namespace {

using nlohmann::ordered_json;

using Claim = std::function<bool(const RunReport&)>;
using Figure = std::function<double(const RunReport&)>;

constexpr double kMinDistance = 0.25;  // [m] the audit's places lie so far apart

/// Of at least one value.
double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

/// Sums the runs up, one group of figures after the other.
class Summary {
 public:
  explicit Summary(const std::vector<const RunReport*>& runs) : runs_(runs) {}

  ordered_json json() {
    json_["runs"] = runs_.size();
    json_["passed"] = count([](const RunReport& r) { return r.passed; });
    if (runs_.empty()) {
      return json_;
    }
    put_localization();
    put_carries();
    put_goals();
    put_jobs();
    put_contacts();
    put_driving();
    put_map();
    put_speed();
    return json_;
  }

 private:
  [[nodiscard]] std::int64_t count(const Claim& claim) const {
    return std::count_if(runs_.begin(), runs_.end(), [&](const RunReport* run) { return claim(*run); });
  }

  [[nodiscard]] double sum(const Figure& figure) const {
    double sum = 0.0;
    for (const RunReport* run : runs_) {
      sum += figure(*run);
    }
    return sum;
  }

  [[nodiscard]] std::vector<double> list(const Figure& figure, const Claim& claim) const {
    std::vector<double> values;
    for (const RunReport* run : runs_) {
      if (claim(*run)) {
        values.push_back(figure(*run));
      }
    }
    return values;
  }

  /// Over the runs of which the claim holds; nothing when it holds of none.
  void put_mean(const char* key, const Figure& figure, const Claim& claim) {
    const std::vector<double> values = list(figure, claim);
    double sum = 0.0;
    for (const double value : values) {
      sum += value;
    }
    if (!values.empty()) {
      json_[key] = rounded(sum / static_cast<double>(values.size()));
    }
  }

  /// Over the runs in which it was measured.
  void put_mean(const char* key, std::optional<double> RunReport::*figure) {
    put_mean(
        key, [figure](const RunReport& r) { return (r.*figure).value(); },
        [figure](const RunReport& r) { return (r.*figure).has_value(); });
  }

  void put_quantile(const char* key, const std::vector<double>& values, double q) {
    if (!values.empty()) {
      json_[key] = rounded(quantile(values, q));
    }
  }

  void put_localization() {
    const Claim localized = [](const RunReport& r) { return r.localized; };
    json_["localized_ratio"] = rounded(static_cast<double>(count(localized)) / static_cast<double>(runs_.size()));
    json_["confident_wrong_runs"] = count([](const RunReport& r) { return r.confident_wrong_s > 0.0; });
    const std::vector<double> distances = list([](const RunReport& r) { return r.localized_after_m; }, localized);
    put_quantile("localized_after_m_median", distances, 0.5);
    put_quantile("localized_after_m_p95", distances, 0.95);
    put_path_ratio();
    put_mean(
        "tracking_ratio", [](const RunReport& r) { return r.tracking_ratio; }, localized);
    put_mean("in_view_position_rms_m", &RunReport::in_view_position_rms_m);
    put_mean("in_view_heading_rms_deg", &RunReport::in_view_heading_rms_deg);
    put_mean("mission_position_p95_m", &RunReport::mission_position_p95_m);
    put_mean("mission_heading_p95_deg", &RunReport::mission_heading_p95_deg);
    put_mean("nees", &RunReport::nees);
  }

  /// Way driven until localized, as a multiple of the least that would tell the pose from there.
  void put_path_ratio() {
    const Claim known = [](const RunReport& r) {
      return r.localized && r.resolvable_after_m >= 0.0 && std::isfinite(r.resolvable_after_m);
    };
    const std::vector<double> ratios = list(
        [](const RunReport& r) { return r.localized_after_m / std::max(kMinDistance, r.resolvable_after_m); }, known);
    put_quantile("way_ratio_median", ratios, 0.5);
    put_quantile("way_ratio_p95", ratios, 0.95);
    put_quantile("resolvable_after_m_median", list([](const RunReport& r) { return r.resolvable_after_m; }, known),
                 0.5);
    put_quantile("resolvable_after_m_p95", list([](const RunReport& r) { return r.resolvable_after_m; }, known), 0.95);
  }

  void put_carries() {
    int carries = 0;
    int noticed = 0;
    int recovered = 0;
    for (const RunReport* run : runs_) {
      carries += run->carries;
      noticed += run->carries_noticed;
      recovered += run->carries_recovered;
    }
    if (carries > 0) {
      json_["carries"] = carries;
      json_["carries_noticed"] = noticed;
      json_["carries_recovered"] = recovered;
    }
  }

  void put_goals() {
    int goals = 0;
    int reached = 0;
    int to_refuse = 0;
    int refused_right = 0;
    std::vector<double> errors;
    for (const RunReport* run : runs_) {
      for (const GoalResult& goal : run->goals) {
        (goal.expect_refused ? to_refuse : goals) += 1;
        reached += goal.reached && !goal.expect_refused ? 1 : 0;
        refused_right += goal.expect_refused && goal.refused ? 1 : 0;
        if (goal.reached) {
          errors.push_back(goal.error_m);
        }
      }
    }
    if (goals > 0) {
      json_["goals"] = goals;
      json_["goals_reached"] = reached;
      put_quantile("goal_error_p95_m", errors, 0.95);
    }
    if (to_refuse > 0) {
      json_["goals_to_refuse"] = to_refuse;
      json_["refused_right"] = refused_right;
    }
  }

  void put_jobs() {
    int jobs = 0;
    int right = 0;
    int lost_or_doubled = 0;
    for (const RunReport* run : runs_) {
      if (run->jobs) {
        jobs += run->jobs->jobs;
        right += run->jobs->right;
        lost_or_doubled += run->jobs->lost + run->jobs->doubled;
      }
    }
    if (jobs > 0) {
      json_["jobs"] = jobs;
      json_["jobs_right"] = right;
      json_["jobs_lost_or_doubled"] = lost_or_doubled;
    }
  }

  void put_contacts() {
    std::int64_t contacts = 0;
    std::map<std::string, int> classes;
    double clearance = 10.0;
    for (const RunReport* run : runs_) {
      contacts += run->contacts;
      clearance = std::min(clearance, run->min_clearance_m);
      for (const ContactEvent& contact : run->drive.contacts) {
        ++classes[contact.with];
      }
    }
    json_["contacts"] = contacts;
    for (const auto& [with, times] : classes) {
      json_["contacts_" + with] = times;
    }
    json_["min_clearance_m"] = rounded(clearance);
  }

  /// Times are of missions that began while the pose was known, against 1.5 times the shortest way at full speed + 10
  /// s.
  void put_driving() {
    constexpr double kSpeed = 0.5;  // [m/s]
    put_mean(
        "mean_speed_m_s", [](const RunReport& r) { return r.mean_speed_m_s; },
        [](const RunReport& r) { return r.mean_speed_m_s > 0.0; });
    std::vector<double> times;
    std::vector<double> headings;
    for (const RunReport* run : runs_) {
      for (const GoalResult& goal : run->goals) {
        if (goal.reached && goal.shortest_m > 0.0) {
          times.push_back(goal.time_s / (1.5 * goal.shortest_m / kSpeed + 10.0));
        }
        if (goal.reached && goal.heading_error_deg) {
          headings.push_back(*goal.heading_error_deg);
        }
      }
    }
    put_quantile("goal_heading_p95_deg", headings, 0.95);
    put_quantile("mission_time_ratio_median", times, 0.5);
    put_quantile("mission_time_ratio_p95", times, 0.95);
    put_quantile("corridor_share_median",
                 list([](const RunReport& r) { return r.drive.corridor_share; },
                      [](const RunReport& r) { return r.drive.corridor_share >= 0.0; }),
                 0.5);
    json_["oscillating_runs"] = count([](const RunReport& r) { return r.drive.oscillation_s > 0.0; });
    put_mean(
        "path_efficiency", [](const RunReport& r) { return r.path_efficiency; },
        [](const RunReport& r) { return r.path_efficiency > 0.0; });
  }

  void put_map() {
    const Claim mapped = [](const RunReport& r) { return r.map.measured; };
    put_mean(
        "wall_median_m", [](const RunReport& r) { return r.map.wall_median_m; }, mapped);
    put_mean(
        "wall_recall", [](const RunReport& r) { return r.map.wall_recall; }, mapped);
    put_mean(
        "free_precision", [](const RunReport& r) { return r.map.free_precision; }, mapped);
    put_mean(
        "explored", [](const RunReport& r) { return r.map.explored; }, mapped);
  }

  /// Per core: CPU time where it was measured, so that other programs on the machine do not count.
  void put_speed() {
    const double simulated = sum([](const RunReport& r) { return r.simulated_s; });
    const double wall = sum([](const RunReport& r) { return r.wall_s; });
    const double cpu = sum([](const RunReport& r) { return r.cpu_s; });
    json_["real_time_factor"] = rounded(cpu > 0.0 ? simulated / cpu : (wall > 0.0 ? simulated / wall : 0.0));
    if (cpu > 0.0) {
      const auto slowest = std::max_element(runs_.begin(), runs_.end(), [](const RunReport* a, const RunReport* b) {
        return a->worst_step_ms < b->worst_step_ms;
      });
      json_["worst_step_ms"] = rounded((*slowest)->worst_step_ms);
    }
  }

  const std::vector<const RunReport*>& runs_;
  ordered_json json_ = ordered_json::object();
};

RunGroup& find_or_add(std::vector<RunGroup>& groups, const std::string& suite, const std::string& name) {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const RunGroup& group) { return group.suite == suite && group.name == name; });
  return found == groups.end() ? groups.emplace_back(RunGroup{suite, name, {}}) : *found;
}

}  // namespace

ordered_json summary_of(const std::vector<const RunReport*>& runs) {
  return Summary(runs).json();
}

std::vector<const RunReport*> pointers_to(const std::vector<RunReport>& runs) {
  std::vector<const RunReport*> pointers;
  for (const RunReport& run : runs) {
    pointers.push_back(&run);
  }
  return pointers;
}

std::vector<RunGroup> suites_of(const std::vector<RunReport>& runs) {
  std::vector<RunGroup> suites;
  for (const RunReport& run : runs) {
    find_or_add(suites, run.suite, run.suite).runs.push_back(&run);
  }
  return suites;
}

std::vector<RunGroup> groups_of(const std::vector<RunReport>& runs) {
  std::vector<RunGroup> groups;
  for (const RunReport& run : runs) {
    find_or_add(groups, run.suite, run.group.empty() ? run.scenario : run.group).runs.push_back(&run);
  }
  return groups;
}

std::vector<RunGroup> rows_of(const std::vector<RunReport>& runs) {
  const std::vector<RunGroup> suites = suites_of(runs);
  const std::vector<RunGroup> groups = groups_of(runs);
  std::vector<RunGroup> rows;
  for (const RunGroup& suite : suites) {
    const std::size_t at = rows.size();
    std::copy_if(groups.begin(), groups.end(), std::back_inserter(rows),
                 [&](const RunGroup& group) { return group.suite == suite.name; });
    if (suites.size() > 1 && rows.size() - at > 1) {
      rows.insert(rows.begin() + static_cast<std::ptrdiff_t>(at), suite);
    }
  }
  return rows;
}

}  // namespace luminav
