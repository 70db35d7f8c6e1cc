#pragma once

#include <vector>

#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/lane_map.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "tests/evaluation/report/run_report.hpp"
#include "tests/evaluation/report/trail_point.hpp"

namespace luminav {

/// Compares the sonars' evidence with the true walls and boxes: median distance of occupied cells' centres to the
/// nearest true face, from either side, share of wall faces that the robot passed in line of sight, within 3 m and 60
/// degrees of their normal, and that have evidence within one cell, share of free evidence that is truly free, share of
/// the floor within the robot's reach that is known to be free. Not measured when there is hardly any evidence.
MapResult score_map(const OccupancyGrid& grid, const WorldTruth& world, const std::vector<TrailPoint>& trail);

/// Length [m] of the shortest 8-connected way between two points for a disc of the given radius, octile metric, not
/// against `lanes`; a negative number when there is none.
double octile_length(const PriorMap& walls, const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius,
                     const LaneMap& lanes = {});

/// Cells that the middle of a disc of the given radius can get to, 8-connected, not against `lanes`; none when the disc
/// is outside or does not fit where it begins.
std::vector<bool> reachable_cells(const PriorMap& walls, const Eigen::Vector2d& from, double radius,
                                  const LaneMap& lanes = {});

}  // namespace luminav
