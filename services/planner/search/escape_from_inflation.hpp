#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/planner/search/cost_field.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {

struct EscapeFromInflationParams {
  double reach = 1.0;         // [m] from the robot
  double body_radius = 0.22;  // [m] what seems to stand this close to the robot's middle cannot be there
  double hard_radius = 0.30;  // [m] the space's own
  double zone_reach = 15.0;   // [m] from a robot inside a keep-out zone
};

/// Finds the escape of a robot beside an obstacle, through cells that are blocked, never through solid ones; and for
/// one inside a keep-out zone, through that zone.
class EscapeFromInflation {
 public:
  /// `robot` [m, world] is in a cell inside the space, which must outlive this.
  EscapeFromInflation(const ConfigurationSpace& space, const EscapeFromInflationParams& params,
                      const Eigen::Vector2d& robot);

  /// Cells from the robot's to one that the field reached, both included, so that the cost there and from there on is
  /// least. Empty when there is none.
  [[nodiscard]] std::vector<std::size_t> find(const CostField& field) const;
  /// True if no free cell can be reached, wherever the goal is.
  [[nodiscard]] bool is_enclosed() const;

 private:
  /// Within reach, and nothing solid, as far as the robot doesn't stand there itself.
  [[nodiscard]] bool may_enter(const Cell& cell) const;
  /// Price of a cell that may be entered.
  [[nodiscard]] std::uint32_t price(const Cell& cell) const;
  [[nodiscard]] std::size_t cells_in_reach() const;
  /// Index of a cell within reach, row by row.
  [[nodiscard]] std::size_t local(const Cell& cell) const;
  [[nodiscard]] Cell cell_of(std::size_t index) const;

  const ConfigurationSpace& space_;
  EscapeFromInflationParams params_;
  Eigen::Vector2d robot_;
  Cell start_;
  bool starts_in_zone_;
  int reach_;  // [cells]
};

}  // namespace luminav
