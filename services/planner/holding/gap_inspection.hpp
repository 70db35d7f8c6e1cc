#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "services/planner/goals/route_map.hpp"

namespace luminav {

/// A place that evidence closes, but not surely.
struct Gap {
  Polyline path;               // through it
  std::size_t blocked_at = 0;  // the first point of the path that is blocked
};

/// Gaps worth a look from near. Far, oblique echoes draw wide arcs from door posts, so that doors look narrow or shut
/// on the robot's own map until it has looked at them from near.
class GapInspection {
 public:
  /// A new stop, or a new try.
  void reset();
  /// The gap through which the path would be much shorter than `route`, or possible at all. Nothing where a building's
  /// map tells walls from what sonars draw wrongly, or when no gap is left that stayed shut when it was looked at.
  [[nodiscard]] std::optional<Gap> choose(const RouteMap& map, const RouteRequest& request, const Route& route);
  /// True if a path is so long that the gap is looked at first.
  [[nodiscard]] bool is_long(const RouteMap& map, const Polyline& path) const {
    return map.length_with_unknown(path) > limit_;
  }

 private:
  [[nodiscard]] std::optional<Gap> best_gap(const RouteMap& map, const RouteRequest& request, double length);

  std::vector<SuspectedObstacle> looked_at_;  // gaps that stayed shut when seen from near
  bool has_looked_twice_ = false;             // at all of them
  double limit_ = 0.0;                        // [m] a shorter detour is taken without the look, unknown counted more
};

}  // namespace luminav
