#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "services/controller/safety/footprint.hpp"
#include "services/controller/safety/plane_points.hpp"

namespace luminav {

/// Something the robot must not touch, in the robot frame.
struct ObstaclePoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // [m] robot frame
  double approach = 0.0;                               // [m/s] how fast it may come nearer by itself
  double age = 0.0;                                    // [s] since it was measured
  bool is_known = false;                               // the building's map has it
  bool has_stood = false;                              // something was heard there before: it doesn't walk
  bool is_zone = false;                                // the edge of a keep-out zone, which nobody hears
};

/// All that stands around the robot in one step of control: what was measured, then the walls of the building's map.
/// The step looks at it again and again, mostly for what is near, so each point's distance from the upright box around
/// the outline, which is never more than that from the outline itself, is taken once.
class Obstacles {
 public:
  explicit Obstacles(const Footprint& footprint) : footprint_(footprint) {}
  Obstacles(const Footprint& footprint, std::span<const ObstaclePoint> measured) : footprint_(footprint) {
    set(measured, {});
  }

  /// Takes the place of all before. Walls are points [m] in the robot frame; the last `zones` of them are edges of
  /// keep-out zones.
  void set(std::span<const ObstaclePoint> measured, const PlanePoints& walls, std::size_t zones = 0);
  /// The same from another place.
  [[nodiscard]] Obstacles seen_from(const Pose2& there_from_here) const;

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const PlanePoints& points() const { return points_; }
  [[nodiscard]] Eigen::Vector2d position(std::size_t i) const { return points_[i]; }
  [[nodiscard]] ObstaclePoint operator[](std::size_t i) const {
    return i < measured_.size() ? measured_[i] : wall_at(points_[i], i >= size() - zones_);
  }
  [[nodiscard]] std::span<const ObstaclePoint> measured() const { return measured_; }
  [[nodiscard]] const Footprint& footprint() const { return footprint_; }

  /// True only of points at least `distance` [m] away from the outline, though not of all of them: cheap.
  [[nodiscard]] bool is_surely_beyond(std::size_t i, double distance) const {
    const double reach = distance + Footprint::kRounding;
    return reach > 0.0 && squared_from_box_[i] > reach * reach;
  }
  /// Distance [m] from the outline to the nearest, negative inside; `max` where nothing is nearer.
  [[nodiscard]] double min_distance(double max) const;
  /// The same of what is before the wheel axis; meant for a small `max`.
  [[nodiscard]] double min_distance_ahead(double max) const;
  /// The same of what is on no map.
  [[nodiscard]] double min_unknown_distance(double max) const;
  /// The same of what is on no map and was not there half a second ago.
  [[nodiscard]] double min_news_distance(double max) const;
  /// Calls `visit(i)` for all that are at most `distance` [m] from the outline, in order, and for a few more.
  template <typename Visit>
  void visit_within(double distance, const Visit& visit) const {
    const double reach = std::max(0.0, distance + Footprint::kRounding);
    for (std::size_t block = 0; block < min_of_block_.size(); ++block) {
      if (min_of_block_[block] > reach * reach) {
        continue;  // mostly
      }
      const std::size_t first = block * kBlock;
      for (std::uint64_t near = within(first, reach * reach); near != 0; near &= near - 1) {
        visit(first + static_cast<std::size_t>(std::countr_zero(near)));
      }
    }
  }

 private:
  static constexpr std::size_t kBlock = Footprint::kBlock;  // points, one bit each
  static_assert(kBlock == 64);

  static ObstaclePoint wall_at(const Eigen::Vector2d& position, bool is_zone) {
    return {position, 0.0, 0.0, true, false, is_zone};
  }
  /// Which of a block's points have at most this squared distance [m^2] from the box.
  [[nodiscard]] std::uint64_t within(std::size_t first, double squared) const;
  void measure();
  /// The least distance of those measured that count.
  template <class Counts>
  [[nodiscard]] double min_distance_of(double max, const Counts& counts) const;

  Footprint footprint_;
  std::vector<ObstaclePoint> measured_;
  PlanePoints points_;                    // of all
  std::size_t zones_ = 0;                 // the last of them
  std::vector<double> squared_from_box_;  // [m^2] of each point; whole blocks, infinite beyond the last point
  std::vector<double> min_of_block_;      // [m^2] of these
};

}  // namespace luminav
