#pragma once

#include <luminav/grid_tile_t.hpp>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "services/common/log/log_file.hpp"
#include "tests/replay/replay_run.hpp"

namespace luminav {

/// The newest tile of each place of a map. Only those are unpacked, when the map is wanted.
class NewestTiles {
 public:
  void add(const std::vector<std::uint8_t>& data);
  /// Nothing when there was no tile.
  [[nodiscard]] std::optional<OccupancyGrid> grid() const;

 private:
  GridGeometry geometry_;
  std::map<std::pair<int, int>, grid_tile_t> tiles_;
};

/// What nodes said when the log was recorded, what they say now, and the truth; compared in the end.
class ReplayTracks {
 public:
  /// Recorded and replayed messages go into the report's divergence watch at once.
  explicit ReplayTracks(ReplayReport& report) : report_(report) {}

  void add_truth(const LogEvent& event);
  /// Odometry that the next replayed poses belong to.
  void set_odometry(const Pose2& odom_from_robot) { odometry_ = odom_from_robot; }
  void add_recorded(LogEvent event);
  void add_replayed(LogEvent event);
  /// Fills in all figures that compare the two.
  void conclude(double departure);

 private:
  ReplayReport& report_;
  Pose2 odometry_;
  ReferenceTrack truth_;
  std::vector<PoseSample> recorded_;
  std::vector<PoseSample> replayed_;
  std::vector<Pose2> odometries_;  // one for each of replayed_
  NewestTiles recorded_tiles_;
  NewestTiles tiles_;
};

}  // namespace luminav
