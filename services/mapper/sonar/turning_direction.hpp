#pragma once

#include <Eigen/Core>

namespace luminav {

/// Cosine and sine of an angle [rad]; the last ones asked for are kept, since what is drawn of one reading asks for
/// them again.
Eigen::Vector2d unit_vector(double angle);

/// Turns by one step after the other without asking for sines again.
class TurningDirection {
 public:
  /// Begins at an angle [rad]; each step turns by another one.
  TurningDirection(double angle, double step) {
    const Eigen::Vector2d start = unit_vector(angle);
    const Eigen::Vector2d turn = unit_vector(step);
    x_ = start.x();
    y_ = start.y();
    turn_x_ = turn.x();
    turn_y_ = turn.y();
  }
  [[nodiscard]] double x() const { return x_; }
  [[nodiscard]] double y() const { return y_; }
  /// What each step turns by, as a direction.
  [[nodiscard]] double turn_x() const { return turn_x_; }
  [[nodiscard]] double turn_y() const { return turn_y_; }
  /// From here on each step turns twice as far.
  void double_turn() {
    const double x = turn_x_ * turn_x_ - turn_y_ * turn_y_;
    turn_y_ = 2.0 * turn_x_ * turn_y_;
    turn_x_ = x;
  }
  void advance() {
    const double x = x_ * turn_x_ - y_ * turn_y_;
    y_ = x_ * turn_y_ + y_ * turn_x_;
    x_ = x;
  }

 private:
  double x_;
  double y_;
  double turn_x_;
  double turn_y_;
};

}  // namespace luminav
