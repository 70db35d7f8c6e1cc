#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tests/evaluation/report/run_report.hpp"
#include "tests/replay/replay_run.hpp"

namespace luminav {
namespace {

using nlohmann::ordered_json;

double elapsed(const ReplayReport& report, std::int64_t utime) {
  return static_cast<double>(utime - report.first_utime) * 1e-6;
}

std::string localized(const TrackFigures& figures) {
  return figures.localized_s < 0.0 ? "never" : fmt::format("{:.1f} s", figures.localized_s);
}

std::string track_table(const ReplayReport& r) {
  const bool has_record = r.recorded.poses > 0;
  std::string text =
      fmt::format("\n{:<36} {:>12} {:>12}\n",
                  r.has_truth ? "poses against the truth" : "poses against the recorded ones", "recorded", "replayed");
  const auto row = [&](const char* what, const std::string& recorded, const std::string& replayed) {
    text += fmt::format("{:<36} {:>12} {:>12}\n", what, has_record ? recorded : "-", replayed);
  };
  const TrackFigures& a = r.recorded;
  const TrackFigures& b = r.replayed;
  const auto errors = [&](const char* what, double TrackFigures::*figure, const char* form, double scale) {
    const auto said = [&](const TrackFigures& f) {
      return f.compared > 0 ? fmt::format(fmt::runtime(form), scale * f.*figure) : std::string("-");
    };
    row(what, said(a), said(b));
  };
  row("poses", fmt::format("{}", a.poses), fmt::format("{}", b.poses));
  row("first TRACKING after", localized(a), localized(b));
  row("TRACKING since then", fmt::format("{:.1f} %", 100.0 * a.tracking_ratio),
      fmt::format("{:.1f} %", 100.0 * b.tracking_ratio));
  row("changes of state", fmt::format("{}", a.state_changes), fmt::format("{}", b.state_changes));
  errors("position RMS", &TrackFigures::position_rms, "{:.3f} m", 1.0);
  errors("position 95 %", &TrackFigures::position_p95, "{:.3f} m", 1.0);
  errors("position, largest", &TrackFigures::position_max, "{:.3f} m", 1.0);
  errors("heading RMS", &TrackFigures::heading_rms, "{:.2f} deg", degrees(1.0));
  errors("heading 95 %", &TrackFigures::heading_p95, "{:.2f} deg", degrees(1.0));
  errors("confidently wrong", &TrackFigures::wrong_s, "{:.1f} s", 1.0);
  return text;
}

ordered_json json_of(const TrackFigures& f) {
  const auto measured = [&](double figure) {
    return f.compared > 0 ? ordered_json(rounded(figure)) : ordered_json(nullptr);
  };
  return {{"poses", f.poses},
          {"compared", f.compared},
          {"localized_s", f.localized_s < 0.0 ? ordered_json(nullptr) : ordered_json(rounded(f.localized_s))},
          {"tracking_ratio", rounded(f.tracking_ratio)},
          {"state_changes", f.state_changes},
          {"position_rms_m", measured(f.position_rms)},
          {"position_p95_m", measured(f.position_p95)},
          {"position_max_m", measured(f.position_max)},
          {"heading_rms_deg", measured(degrees(f.heading_rms))},
          {"heading_p95_deg", measured(degrees(f.heading_p95))},
          {"confident_wrong_s", measured(f.wrong_s)}};
}

}  // namespace

std::string to_text(const ReplayReport& r) {
  std::string text =
      r.cpu_s > 0.0
          ? fmt::format("replayed {} on {:.1f} s in {:.2f} s: {:.0f} times real time, {:.0f} by processor time\n",
                        fmt::join(r.nodes, ", "), r.log_s, r.wall_s, r.real_time_factor(), r.processor_factor())
          : fmt::format("answers of {} on {:.1f} s\n", fmt::join(r.nodes, ", "), r.log_s);
  text += fmt::format("{} messages fed, {} written, {} refused by the nodes\n", r.fed, r.written, r.dropped);
  if (r.has_poses) {
    text += track_table(r);
  }
  if (r.map.measured) {
    text += fmt::format("\nmap: {} cells occupied, recorded {}; {:.1f} % of them in one map only\n",
                        r.map.replayed_cells, r.map.recorded_cells, 100.0 * r.map.difference);
  }
  text += fmt::format("\n{:<20} {:>9} {:>9} {:>10}  {}\n", "output", "recorded", "replayed", "identical",
                      "first difference");
  for (const auto& [channel, d] : r.divergence.channels()) {
    text += fmt::format("{:<20} {:>9} {:>9} {:>10}  {}\n", channel, d.recorded, d.replayed, d.identical,
                        d.recorded == 0 ? "not recorded"
                        : d.differs     ? fmt::format("{:.2f} s: {}", elapsed(r, d.first_utime), d.first_what)
                                        : "-");
  }
  if (!r.steps.empty()) {
    text += fmt::format("\n{:<20} {:>9} {:>10} {:>11}\n", "handling", "messages", "mean us", "longest us");
  }
  for (const auto& [channel, step] : r.steps) {
    text += fmt::format("{:<20} {:>9} {:>10.1f} {:>11.1f}\n", channel, step.count,
                        1e6 * step.sum / static_cast<double>(step.count), 1e6 * step.longest);
  }
  text += "\n";
  for (const std::string& remark : r.remarks) {
    text += remark + "\n";
  }
  const std::string first = r.divergence.first_channel();
  if (!first.empty() && r.divergence.channels().at(first).recorded > 0) {
    const ChannelDivergence& d = r.divergence.channels().at(first);
    text += fmt::format("first divergence: {:.3f} s, {}: {}\n", elapsed(r, d.first_utime), first, d.first_what);
  }
  if (r.departed) {
    text += fmt::format("the poses leave the recorded ones {:.3f} s after the start\n", elapsed(r, *r.departed));
  }
  text += fmt::format("sha256: {}\n", r.sha256);
  for (const std::string& failure : r.failures) {
    text += fmt::format("FAILED: {}\n", failure);
  }
  text += r.passed() ? "passed\n" : "";
  if (!r.log_damage.empty()) {
    text += r.log_damage + "\n";
  }
  return text;
}

std::string to_json(const ReplayReport& r, const ReplayOptions& options) {
  ordered_json channels = ordered_json::object();
  for (const auto& [channel, d] : r.divergence.channels()) {
    channels[channel] = {{"recorded", d.recorded}, {"replayed", d.replayed}, {"identical", d.identical}};
    if (d.differs) {
      channels[channel]["first_s"] = rounded(elapsed(r, d.first_utime));
      channels[channel]["first"] = d.first_what;
    }
  }
  ordered_json steps = ordered_json::object();
  for (const auto& [channel, step] : r.steps) {
    steps[channel] = {{"count", step.count},
                      {"mean_us", rounded(1e6 * step.sum / static_cast<double>(step.count))},
                      {"longest_us", rounded(1e6 * step.longest)}};
  }
  const std::string first = r.divergence.first_channel();
  ordered_json all = {{"log", options.log_file},
                      {"nodes", r.nodes},
                      {"passed", r.passed()},
                      {"failures", r.failures},
                      {"remarks", r.remarks},
                      {"log_damage", r.log_damage},
                      {"sha256", r.sha256},
                      {"log_s", rounded(r.log_s)},
                      {"wall_s", rounded(r.wall_s)},
                      {"cpu_s", rounded(r.cpu_s)},
                      {"real_time_factor", rounded(r.real_time_factor())},
                      {"processor_factor", rounded(r.processor_factor())},
                      {"reference", r.has_truth ? "truth" : "recorded"},
                      {"first_divergence", nullptr},
                      {"channels", channels},
                      {"steps", steps}};
  if (!first.empty()) {
    all["first_divergence"] = {{"s", rounded(elapsed(r, r.divergence.channels().at(first).first_utime))},
                               {"channel", first}};
  }
  if (r.has_poses) {
    all["recorded"] = r.recorded.poses > 0 ? json_of(r.recorded) : ordered_json(nullptr);
    all["replayed"] = json_of(r.replayed);
  }
  if (r.map.measured) {
    all["map"] = {{"recorded_cells", r.map.recorded_cells},
                  {"replayed_cells", r.map.replayed_cells},
                  {"difference", rounded(r.map.difference)}};
  }
  return all.dump(2) + "\n";
}

}  // namespace luminav
