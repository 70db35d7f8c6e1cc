#include "tests/evaluation/report/report_part.hpp"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "services/common/configuration/configuration_error.hpp"
#include "tests/evaluation/report/evaluation_report.hpp"

namespace nlohmann {

template <typename T>
struct adl_serializer<std::optional<T>> {
  static void to_json(json& target, const std::optional<T>& value) { target = value ? json(*value) : json(nullptr); }
  static void from_json(const json& source, std::optional<T>& value) {
    value = source.is_null() ? std::nullopt : std::optional(source.get<T>());
  }
};

}  // namespace nlohmann

namespace luminav {

using nlohmann::json;

// A trail has hundreds of points: an array each, without names.
inline void to_json(json& target, const TrailPoint& p) {
  target = {p.truth.x,    p.truth.y,    p.truth.theta,    p.believed.x, p.believed.y, p.believed.theta,
            p.odometry.x, p.odometry.y, p.odometry.theta, p.state,      p.estimator,  p.time};
}

inline void from_json(const json& source, TrailPoint& p) {
  int i = 0;
  for (double* value : {&p.truth.x, &p.truth.y, &p.truth.theta, &p.believed.x, &p.believed.y, &p.believed.theta,
                        &p.odometry.x, &p.odometry.y, &p.odometry.theta}) {
    source.at(static_cast<std::size_t>(i++)).get_to(*value);
  }
  source.at(9).get_to(p.state);
  source.at(10).get_to(p.estimator);
  source.at(11).get_to(p.time);
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GoalResult, x, y, reached, refused, expect_refused, error_m, heading_error_deg,
                                   time_s, shortest_m, cause)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ContactEvent, at_s, with, x, y, theta_deg, linear, angular, control_state)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DriveResult, contacts, oscillation_s, corridor_share)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ProcessResult, name, cpu_percent, rss_mb, restarts)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MapResult, measured, wall_median_m, wall_recall, free_precision, explored)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ZoneResult, keep_out_m, leaving_s, over_speed_m_s, against_m, path_ratio, path_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(JobsResult, jobs, right, lost, doubled, answers, guides_left, returns, homes,
                                   charging, charger_tries, min_voltage, kills, wrong)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RunReport, scenario, seed, suite, group, passed, failure, simulated_s, wall_s, cpu_s,
                                   worst_step_ms, world_table, world_hash, localized, localized_s, localized_after_m,
                                   resolvable_after_m, tracking_ratio, ambiguous_ratio, confident_wrong_s,
                                   in_view_position_rms_m, in_view_heading_rms_deg, mission_position_p95_m,
                                   mission_heading_p95_deg, nees, mean_speed_m_s, path_efficiency, driven_m, goals,
                                   contacts, hard_contacts, min_clearance_m, carries, carries_noticed,
                                   carries_recovered, drive, map, zones, jobs, processes, scenario_file, reproduce,
                                   trail, log)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DetectorCondition, name, frames, precision, recall, plain, plain_recall,
                                   false_per_100_frames, centre_rms_px, orientation_rms_deg, milliseconds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Shard, index, count)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReportPart, shard, suite, mode, sensing, sensing_remark, plan, runs, detector)

Shard read_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, error] = std::from_chars(text.data(), end, shard.index);
  if (error == std::errc() && slash != end && *slash == '/') {
    const auto [stop, failure] = std::from_chars(slash + 1, end, shard.count);
    if (failure == std::errc() && stop == end && shard.index >= 1 && shard.index <= shard.count) {
      return shard;
    }
  }
  throw ConfigurationError(fmt::format("--shard {}: must be I/N with I from 1 to N, such as 3/8", text));
}

std::string to_cbor(const ReportPart& part) {
  std::string text;
  json::to_cbor(json(part), text);
  return text;
}

ReportPart part_of_cbor(const std::string& cbor, const std::string& name) {
  try {
    ReportPart part = json::from_cbor(cbor).get<ReportPart>();
    if (part.shard.index >= 1 && part.shard.index <= part.shard.count &&
        part.runs.size() == runs_of_shard(part.plan, part.shard).size()) {
      return part;
    }
  } catch (const json::exception&) {
    // said below
  }
  throw std::runtime_error(fmt::format("{}: not a whole part of an evaluation, as evaluate --shard writes it", name));
}

ReportPart joined(const std::vector<std::pair<std::string, ReportPart>>& parts) {
  const auto& [first_name, first] = parts.at(0);
  const auto count = static_cast<std::size_t>(first.shard.count);
  std::vector<const ReportPart*> by_index(count);
  const auto what = [](const ReportPart& p) { return std::tie(p.shard.count, p.suite, p.mode, p.sensing, p.plan); };
  for (const auto& [name, part] : parts) {
    if (what(part) != what(first)) {
      throw std::runtime_error(fmt::format("{} and {}: are parts of different evaluations", first_name, name));
    }
    if (std::exchange(by_index[static_cast<std::size_t>(part.shard.index - 1)], &part) != nullptr) {
      throw std::runtime_error(fmt::format("{}: part {}/{} is there twice", name, part.shard.index, count));
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (by_index[i] == nullptr) {
      throw std::runtime_error(fmt::format("--merge: part {}/{} is missing", i + 1, count));
    }
  }
  ReportPart whole = *by_index[0];
  whole.shard = {};
  whole.runs.clear();
  for (std::size_t i = 0; i < whole.plan.size(); ++i) {
    whole.runs.push_back(by_index[i % count]->runs[i / count]);
  }
  return whole;
}

std::string to_json(const ReportPart& part) {
  return to_json(part.suite, part.mode, part.sensing, part.runs, part.detector);
}

}  // namespace luminav
