#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "services/controller/safety/footprint.hpp"

namespace luminav {

/// Whether an obstacle is the edge of a keep-out zone, which nobody hears: of the robot's pose, or of one of several
/// that are possible. The latter stops no turn on the spot: it takes the robot's middle nowhere, and begins each
/// search.
enum class ZoneEdge : std::uint8_t { kNone, kCertain, kPossible };

/// Something the robot must not touch, in the robot frame.
struct ObstaclePoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // [m] robot frame
  double approach = 0.0;                               // [m/s] how fast it may come nearer by itself
  double age = 0.0;                                    // [s] since it was measured
  bool is_known = false;                               // the building's map has it
  bool has_stood = false;                              // something was heard there before: it doesn't walk
  ZoneEdge zone_edge = ZoneEdge::kNone;
};

/// All that stands around the robot in one step of control: what was measured, then the walls of the building's map.
/// The step asks again and again for what is near, so each point's distance from the upright box around the outline,
/// which is never more than that from the outline itself, is taken once.
class Obstacles {
 public:
  explicit Obstacles(const Footprint& footprint, std::span<const ObstaclePoint> measured = {}) : footprint_(footprint) {
    set(measured, {});
  }

  /// Replaces all before. Walls are points [m] in the robot frame; the last `zones` of them are edges of keep-out zones
  /// of the kind given.
  void set(std::span<const ObstaclePoint> measured, std::span<const Eigen::Vector2d> walls, std::size_t zones = 0,
           ZoneEdge edge = ZoneEdge::kCertain);
  /// Obstacles as they are seen from another place.
  [[nodiscard]] Obstacles seen_from(const Pose2& there_from_here) const;

  [[nodiscard]] const std::vector<ObstaclePoint>& points() const { return points_; }
  [[nodiscard]] std::span<const ObstaclePoint> measured() const { return std::span(points_).first(measured_); }
  [[nodiscard]] const Footprint& footprint() const { return footprint_; }

  /// Distance [m] from the outline to the nearest, negative inside; `max` where nothing is nearer.
  [[nodiscard]] double min_distance(double max) const;
  /// Distance [m] to the nearest in front of the wheel axis.
  [[nodiscard]] double min_distance_ahead(double max) const;
  /// Distance [m] to the nearest that is on no map.
  [[nodiscard]] double min_unknown_distance(double max) const;
  /// Distance [m] to the nearest that is on no map and was not there half a second ago.
  [[nodiscard]] double min_news_distance(double max) const;
  /// Calls `visit(i)` for all that are at most `distance` [m] from the outline, in order, and for a few more.
  template <typename Visit>
  void visit_within(double distance, const Visit& visit) const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (from_box_[i] <= std::max(distance, 0.0)) {
        visit(i);
      }
    }
  }

 private:
  void measure();
  /// Distance to the nearest that counts.
  template <class Counts>
  [[nodiscard]] double min_distance_of(double max, const Counts& counts) const;

  Footprint footprint_;
  std::vector<ObstaclePoint> points_;
  std::size_t measured_ = 0;      // of the points; the others are walls
  std::vector<double> from_box_;  // [m] of each point
};

}  // namespace luminav
