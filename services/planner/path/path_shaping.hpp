#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/planner/path/side_keeping.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {

struct PathShapingParams {
  double shortcut_length = 8.0;          ///< [m] the longest straight piece that is tried
  double shortcut_slack = 1.02;          ///< a straight piece may cost this much of what it replaces
  int smoothing_rounds = 40;             ///< of the elastic band
  double tension = 0.30;                 ///< pull towards the middle of the neighbours, each round
  double push = 0.02;                    ///< [m] away from the nearest obstacle, each round, where it is nearest
  double spacing = 0.20;                 ///< [m] between points of the result
  KeepSide keep_side = KeepSide::kNone;  ///< of corridors wide enough for two, as who drives along them sees it
};

/// Cost of a polyline [m of free floor]: length times price, sampled at half a cell.
double cost_of(const ConfigurationSpace& space, const Polyline& points);
double cost_of(const ConfigurationSpace& space, const Eigen::Vector2d& from, const Eigen::Vector2d& to);
/// True if a straight piece touches no blocked cell, sampled at half a cell, and goes against no one-way zone.
bool is_clear(const ConfigurationSpace& space, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

/// True if no piece of a polyline touches a blocked cell.
bool is_clear(const ConfigurationSpace& space, const Polyline& points);

double polyline_length(const Polyline& points);
/// Points at most `spacing` [m] apart, first and last kept exactly. At least two points, even of one place.
Polyline resampled(const Polyline& points, double spacing);

/// Makes a chain of cells a path that a person would walk: straight pieces where they cost no more, then an elastic
/// band (Quinlan and Khatib 1993) that rounds corners and keeps to the middle, or to a side. First and last point stay.
/// Never leads through a blocked cell that the chain did not touch.
Polyline shape_path(const ConfigurationSpace& space, const PathShapingParams& params, const Polyline& chain);

}  // namespace luminav
