#pragma once

#include <Eigen/Core>
#include <optional>

#include "services/planner/goals/goal_types.hpp"

namespace luminav {

/// Measures how far the robot has driven for a stop where no building's map says whether a path leads there at all:
/// there is always one more to try.
class SearchEffort {
 public:
  explicit SearchEffort(const GoalParams& params) : ratio_(params.search_ratio), length_(params.search_length) {}

  /// A new stop, or a new try.
  void reset();
  /// The first path was so long [m].
  void expect(double length) { first_length_ = first_length_ > 0.0 ? first_length_ : length; }
  /// Measures from where the robot [m, world] was last.
  void drive_to(const Eigen::Vector2d& robot);
  /// Wherever the robot is seen next, it has not driven there.
  void interrupt() { last_.reset(); }
  [[nodiscard]] bool is_in_vain() const;
  [[nodiscard]] double driven() const { return driven_; }
  [[nodiscard]] double first_length() const { return first_length_; }

 private:
  double ratio_;
  double length_;              // [m]
  double first_length_ = 0.0;  // [m]
  double driven_ = 0.0;        // [m]
  std::optional<Eigen::Vector2d> last_;
};

}  // namespace luminav
