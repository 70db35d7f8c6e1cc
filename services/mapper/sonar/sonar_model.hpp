#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// How one reading becomes votes of cells: the paper's line segment, or a cone with weights by range and angle.
enum class SonarModelKind { kLine, kCone };

struct SonarModelParams {
  SonarModelKind kind = SonarModelKind::kCone;
  double half_angle = radians(15.0);  ///< [rad] of the cone
  double minimum_range = 0.10;        ///< [m] nearer readings say nothing
  double maximum_range = 5.0;         ///< [m] readings from here on are no echo
  double free_log_odds = 0.10;        ///< taken from every cell inside the cone
  double core_log_odds = 0.10;        ///< taken beside that in the inner half of the cone, where a miss is rare
  double core_range = 2.0;            ///< [m] up to here
  double occupied_log_odds = 1.20;    ///< given to the cell on the axis at the reading
  double edge_weight = 0.30;          ///< of that at the border of the cone; a parabola between
  double occupied_range = 3.0;  ///< [m] echoes from farther away are too wide to place (1.6 m there): free votes only
  double free_range = 3.0;      ///< [m] nothing is called free beyond
  double no_echo_range = 3.0;   ///< [m] how far a reading without an echo takes occupied evidence away
  double no_echo_share = 0.5;   ///< with this share of the weight: a slanted wall may have thrown it away
  double free_margin = 0.15;    ///< [m] before the reading where nothing is voted
  double min_log_odds = -1.0;   ///< clamp of free evidence; low, so that what stands there anew shows soon
  double max_log_odds = 2.5;    ///< clamp of occupied evidence; low, so that what has gone vanishes soon
};

/// One reading where it was taken.
struct BeamReading {
  Pose2 world_from_sonar;  // x along the axis
  double range = 0.0;      // [m]
  bool has_echo = false;
};

/// The cone is looked at in this many slices: at 3 m one is a cell wide.
inline constexpr int kSlices = 15;
/// How far each slice of the cone can be seen into [m], from the right border to the left one.
using SliceRanges = std::array<double, kSlices>;

/// A piece of a circle between two angles less than half a turn apart.
struct Sector {
  Eigen::Vector2d apex = Eigen::Vector2d::Zero();  // [m] world
  double from_angle = 0.0;                         // [rad] world
  double to_angle = 0.0;                           // [rad] world
  double radius = 0.0;                             // [m]
};

/// Columns [first, last] of one row; empty where last < first.
struct ColumnRange {
  int first = 0;
  int last = -1;
};

/// Rows of a convex region, from the lowest on.
struct SectorRows {
  int first_row = 0;
  std::vector<ColumnRange> columns;
};

/// Cells whose centre lies in a sector, clipped to the grid. Sectors that touch share no cell but those exactly on the
/// line between them.
SectorRows rows_of_sector(const GridGeometry& geometry, const Sector& sector);

/// What is taken from the evidence of a cell.
struct EvidenceVote {
  std::int8_t change = 0;  ///< not above 0
  std::int8_t min = 0;     ///< lower evidence stays as it is

  [[nodiscard]] std::int8_t of(std::int8_t evidence) const {
    return static_cast<std::int8_t>(std::max<int>(evidence + change, std::min(evidence, min)));
  }
};

/// Votes of free space. They need no second look: an echo that came too early leaves only too little of it.
class FreeSpaceModel {
 public:
  explicit FreeSpaceModel(const SonarModelParams& params);
  /// Takes evidence from the cells that the reading saw empty, in each slice out to its limit [m] at most.
  void apply(const BeamReading& reading, const SliceRanges& limits, OccupancyGrid& grid) const;

 private:
  void lower_cone(const Pose2& apex, double half_angle, const SliceRanges& limits, double max, EvidenceVote vote,
                  OccupancyGrid& grid) const;
  static void lower_line(const Pose2& apex, double length, const EvidenceVote& vote, OccupancyGrid& grid);

  SonarModelParams params_;
};

/// A cell that an echo may come from.
struct ArcCell {
  Cell cell;
  int slice = 0;        // of the cone, 0 at its right border
  double weight = 1.0;  // 1 on the axis
};

/// Cells on the arc of an echo, from one border of the cone to the other, each once; of the line model only the one on
/// the axis. `widening` [rad] is added at both borders, with the border's weight.
std::vector<ArcCell> cells_of_echo(const SonarModelParams& params, const GridGeometry& geometry,
                                   const BeamReading& reading, double widening);

/// Log-odds as the grid stores them.
std::int8_t to_evidence(double log_odds);

}  // namespace luminav
