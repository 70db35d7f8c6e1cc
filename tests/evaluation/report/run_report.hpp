#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/evaluation/report/trail_point.hpp"

namespace luminav {

struct GoalResult {
  double x = 0.0;                           // [m] world
  double y = 0.0;                           // [m]
  bool reached = false;                     // arrived by its own word and within the tolerances by the truth
  bool refused = false;                     // ended by its own word without arriving
  bool expect_refused = false;              // as the scenario has it
  double error_m = 0.0;                     // true distance when it ended
  std::optional<double> heading_error_deg;  // true, when it ended; nothing where no heading was asked for
  double time_s = 0.0;                      // from the request
  double shortest_m = -1.0;  // octile way of a disc of 0.30 m from where it was requested; negative = not compared
  std::string cause;         // its last sentence
};

/// The robot touched something by its own motion.
struct ContactEvent {
  double at_s = 0.0;  // since the start
  std::string with;   // wall | box | person | hard (what sonar hardly sees)
  double x = 0.0;     // [m] true pose, world
  double y = 0.0;     // [m]
  double theta_deg = 0.0;
  double linear = 0.0;    // [m/s] last command
  double angular = 0.0;   // [rad/s]
  int control_state = 0;  // as in CONTROL_STATUS
};

/// How the robot drove.
struct DriveResult {
  std::vector<ContactEvent> contacts;
  double oscillation_s = 0.0;    // in which the heading command changed its sign more than 3 times a second for 2 s
  double corridor_share = -1.0;  // median clearance in corridors over what the middle would give; negative = in none
};

/// How the rules of a building's zones were kept, while the pose was TRACKING.
struct ZoneResult {
  double keep_out_m = 0.0;      // deepest that the true outline was inside a keep-out zone once it had been outside
  double leaving_s = 0.0;       // longest stay in a keep-out zone that the robot found itself in
  double over_speed_m_s = 0.0;  // true speed above a slow zone's, the largest
  double against_m = 0.0;       // driven against a one-way zone, the longest
  double path_ratio = 0.0;      // way driven to a goal over the shortest allowed one, the largest; 0 = not compared
  double path_m = 0.0;          // that way
};

/// What became of the jobs that people ordered.
struct JobsResult {
  int jobs = 0;                    // ordered ones, tours by the clock, and ways home for the battery
  int right = 0;                   // that ended as they should, at the place where they should
  int lost = 0;                    // promised, and gone without an end
  int doubled = 0;                 // that came to life again after their end, or a tour started twice
  int answers = 0;                 // to questions of the robot
  int guides_left = 0;             // visitors who turned away for good
  int returns = 0;                 // that it went back for a visitor
  int homes = 0;                   // ways home that ended well
  int charging = 0;                // of these, in contact with the charger by the truth
  int charger_tries = 0;           // drives into the dock
  double min_voltage = 0.0;        // [V]
  int kills = 0;                   // of the job service
  std::vector<std::string> wrong;  // one sentence for each job that did not end as it should
};

struct ProcessResult {
  std::string name;
  double cpu_percent = 0.0;  // of one core, mean
  double rss_mb = 0.0;       // largest
  int restarts = 0;
};

struct MapResult {
  bool measured = false;
  double wall_median_m = 0.0;   // distance of occupied evidence to the nearest true surface
  double wall_recall = 0.0;     // share of wall faces that were near the robot and have evidence within a cell
  double free_precision = 0.0;  // share of free evidence that is truly free
  double explored = 0.0;        // share of the floor the robot's middle can get to that has free evidence
};

/// What one run came to; the JSON keys are the field names, null is what was not measured.
struct RunReport {
  std::string scenario;
  std::uint64_t seed = 0;
  std::string suite;  // that it belongs to, also within "all"; "" = none
  std::string group;  // under which it is summed up; "" = the scenario's name
  bool passed = false;
  std::string failure;  // first reason, "" when passed
  double simulated_s = 0.0;
  double wall_s = 0.0;
  double cpu_s = 0.0;          // of the thread; 0 = not measured, as in the demo
  double worst_step_ms = 0.0;  // CPU time of the slowest 10 ms of simulated time
  std::string world_table;
  std::string world_hash;
  bool localized = false;
  double localized_s = 0.0;
  double localized_after_m = 0.0;
  double resolvable_after_m =
      -1.0;  // shortest drive from that start that tells the pose; infinite = never, -1 = not known
  double tracking_ratio = 0.0;
  double ambiguous_ratio = 0.0;  // share of all time with the state AMBIGUOUS
  double confident_wrong_s = 0.0;
  // Errors while TRACKING; nothing when it never was, or never with a fixture in view.
  std::optional<double> in_view_position_rms_m;
  std::optional<double> in_view_heading_rms_deg;
  std::optional<double> mission_position_p95_m;
  std::optional<double> mission_heading_p95_deg;
  std::optional<double> nees;  // mean normalised error squared per degree of freedom
  double mean_speed_m_s = 0.0;
  double path_efficiency = 0.0;
  double driven_m = 0.0;
  std::vector<GoalResult> goals;
  int contacts = 0;
  int hard_contacts = 0;
  double min_clearance_m = 0.0;
  int carries = 0;
  int carries_noticed = 0;    // out of TRACKING within 1 s of the first contradicting image
  int carries_recovered = 0;  // TRACKING rightly again
  DriveResult drive;
  MapResult map;
  std::optional<ZoneResult> zones;  // nothing where the building has none
  std::optional<JobsResult> jobs;   // nothing where the scenario has none
  std::vector<ProcessResult> processes;
  std::string scenario_file;
  std::string reproduce;  // command that runs it again; "" = not known

  // Not in the JSON: for pictures and for whoever looks for the cause of a failure.
  std::vector<TrailPoint> trail;
  std::vector<std::string> log;
};

/// Four decimals, more than any figure here is worth.
double rounded(double value);
nlohmann::ordered_json json_of(const RunReport& report);
std::string to_json(const RunReport& report);
/// The lines a person reads at the end of a run.
std::string to_text(const RunReport& report);

}  // namespace luminav
