#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/evaluation/judge/run_judge.hpp"
#include "tests/replay/comparison/divergence.hpp"
#include "tests/replay/comparison/pose_track.hpp"

namespace luminav {

/// What a replay may be worse by and still pass.
struct ReplayTolerances {
  double position = 0.10;         // [m] RMS of the poses while TRACKING, to the truth or the recorded poses
  double heading = radians(3.0);  // [rad] RMS of the same
  double wrong = 0.0;             // [s] TRACKING more than 0.5 m or 20 degrees off
  double localized = 10.0;        // [s] later than recorded
  double tracking = 0.05;         // share of time TRACKING below the recorded one
  double map = 0.20;              // share of occupied cells that only one of the two maps has
  bool exact = false;             // every message as recorded, byte for byte
};

struct ReplayOptions {
  std::string log_file;
  std::string against_file;  // log with the outputs to compare with; "" = those in the log itself
  std::string answers_file;  // log with answers of processes to which the log was played; "" = nodes answer here
  std::filesystem::path robot_file;
  std::filesystem::path building_file;
  std::set<std::string> nodes;  // empty = all for which the log has inputs
  std::string out_file;         // "" = none is written, the checksum is the same
  bool keep_inputs = false;     // the new log holds the inputs and the truth too, so it can be replayed itself
  std::optional<std::uint64_t> localizer_seed;
  double camera_shift = 0.0;    // [m] see ReplayNodesConfig; without a detector the recorded detections are shifted
  std::int64_t utc_offset = 0;  // [s] see ReplayNodesConfig
  ReplayTolerances tolerances;
  bool show_progress = false;  // on stderr
};

/// Handling time of the messages of a channel, all replayed nodes together.
struct StepTime {
  std::int64_t count = 0;
  double sum = 0.0;      // [s]
  double longest = 0.0;  // [s]
};

struct MapComparison {
  bool measured = false;
  std::int64_t recorded_cells = 0;  // occupied by evidence
  std::int64_t replayed_cells = 0;
  double difference = 0.0;  // share of those cells that only one has
};

struct ReplayReport {
  std::vector<std::string> failures;  // one sentence each; empty = passed
  std::vector<std::string> remarks;
  std::string log_damage;  // "" = the log is whole
  std::set<std::string> nodes;
  std::string sha256;            // of the new log
  std::int64_t first_utime = 0;  // [us] of the log
  double log_s = 0.0;
  double wall_s = 0.0;  // of the nodes and the feeding, start-up apart
  double cpu_s = 0.0;   // of that on the processor
  std::int64_t fed = 0;
  std::int64_t written = 0;
  std::int64_t dropped = 0;  // inputs that nodes refused
  bool has_truth = false;
  bool has_poses = false;  // the localizer was replayed
  TrackFigures recorded;
  TrackFigures replayed;
  std::optional<std::int64_t> departed;  // [us] first departure of the replayed poses from the recorded ones
  MapComparison map;
  DivergenceWatch divergence;
  std::map<std::string, StepTime> steps;
  std::vector<TrailPoint> trail;      // for the picture: the replayed poses
  std::vector<Pose2> recorded_trail;  // for the picture, while TRACKING
  std::optional<OccupancyGrid> grid;

  [[nodiscard]] bool passed() const { return failures.empty(); }
  [[nodiscard]] double real_time_factor() const { return wall_s > 0.0 ? log_s / wall_s : 0.0; }
  /// The same on a core that nobody else uses.
  [[nodiscard]] double processor_factor() const { return cpu_s > 0.0 ? log_s / cpu_s : 0.0; }
};

/// Feeds the recorded inputs of the chosen nodes to today's nodes, in recorded order and as fast as it can, never what
/// the replayed nodes themselves had sent. Messages of one receive time are fed together, as they came. Throws
/// ConfigurationError and std::runtime_error (a file that is no log, a node without inputs).
ReplayReport replay_log(const ReplayOptions& options);

std::string to_text(const ReplayReport& report);
std::string to_json(const ReplayReport& report, const ReplayOptions& options);

}  // namespace luminav
