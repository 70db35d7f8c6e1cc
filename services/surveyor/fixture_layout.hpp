#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "services/surveyor/floor_plan.hpp"

namespace luminav {

/// A rectangle of floor, inner faces of its walls [m].
struct FloorRectangle {
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  [[nodiscard]] Eigen::Vector2d size() const { return high - low; }
  [[nodiscard]] Eigen::Vector2d centre() const { return 0.5 * (low + high); }
};

/// Hangs fixtures and elements as an electrician does: at a pitch, in rows, and now and then not.
class FixtureLayout {
 public:
  FixtureLayout(const FloorPlanParams& params, Building& building);

  /// One row along the longer side, its axis along it; a detector every third gap.
  void light_corridor(const FloorRectangle& corridor);
  /// Rows and columns that fill the room evenly; often a vent, and a detector.
  void light_room(const FloorRectangle& room);
  /// Where there is light space but no rectangle: one fixture, long side at theta [rad].
  void hang(const Eigen::Vector2d& position, double theta, bool in_corridor);
  void add_vent(const Eigen::Vector2d& position);
  void add_detector(const Eigen::Vector2d& position);

 private:
  double uniform(double low, double high);
  bool chance(double probability);
  [[nodiscard]] bool is_taken(const Eigen::Vector2d& position, double radius) const;
  void hang_in(const FloorRectangle& area, const Eigen::Vector2d& position, double theta, FixtureKind kind,
               bool in_corridor);

  const FloorPlanParams& params_;
  Building& building_;
  std::mt19937_64 rng_;
  double room_theta_ = 0.0;  // [rad] one direction for all rooms of a floor
};

}  // namespace luminav
