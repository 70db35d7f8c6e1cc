#include <fmt/format.h>

#include <algorithm>

#include "services/common/geometry/angle.hpp"
#include "tests/evaluation/report/run_report.hpp"

namespace luminav {
namespace {

/// "" when it was never TRACKING.
std::string pose_error_text(const RunReport& r) {
  if (!r.mission_position_p95_m || !r.mission_heading_p95_deg) {
    return "";
  }
  return fmt::format(
      "  pose error: {}95 % of the mission {:.3f} m, {:.2f} deg{}\n",
      r.in_view_position_rms_m && r.in_view_heading_rms_deg
          ? fmt::format("in view {:.3f} m, {:.2f} deg RMS; ", *r.in_view_position_rms_m, *r.in_view_heading_rms_deg)
          : "",
      *r.mission_position_p95_m, *r.mission_heading_p95_deg, r.nees ? fmt::format("; NEES {:.2f}", *r.nees) : "");
}

std::string jobs_text(const JobsResult& jobs) {
  std::string text = fmt::format(
      "  jobs: {} of {} as they should, {} lost, {} doubled; {} answers asked for; {} visitors turned away, went back "
      "{} times; home {} times, charging {} of them after {} drives into the dock; lowest {:.1f} V; killed {} times\n",
      jobs.right, jobs.jobs, jobs.lost, jobs.doubled, jobs.answers, jobs.guides_left, jobs.returns, jobs.homes,
      jobs.charging, jobs.charger_tries, jobs.min_voltage, jobs.kills);
  for (const std::string& wrong : jobs.wrong) {
    text += "    " + wrong + "\n";
  }
  return text;
}

}  // namespace

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
  text += pose_error_text(r);
  for (std::size_t i = 0; i < r.goals.size(); ++i) {
    const GoalResult& g = r.goals[i];
    text += fmt::format("  goal {} ({:.2f}, {:.2f}): {} after {:.0f} s, {:.3f} m{} off{}\n", i + 1, g.x, g.y,
                        g.reached ? "reached" : (g.refused ? "refused" : "missed"), g.time_s, g.error_m,
                        g.heading_error_deg ? fmt::format(" and {:.1f} deg", *g.heading_error_deg) : "",
                        g.cause.empty() ? "" : ": " + g.cause);
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
    text += fmt::format(
        "  map: walls {:.3f} m off (median), recall {:.1f} %, free precision {:.1f} %, {:.0f} % explored\n",
        r.map.wall_median_m, 100.0 * r.map.wall_recall, 100.0 * r.map.free_precision, 100.0 * r.map.explored);
  }
  text += r.jobs ? jobs_text(*r.jobs) : "";
  for (const ProcessResult& p : r.processes) {
    text += fmt::format("  {:<11} {:5.1f} % of a core, {:5.1f} MB, {} restarts\n", p.name, p.cpu_percent, p.rss_mb,
                        p.restarts);
  }
  return text;
}

}  // namespace luminav
