#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>

#include "services/detector/opposite_sides.hpp"

namespace luminav {

/// What is known of a joint along one side from beyond the fixture's corners; places as in a profile.
struct KnownJoint {
  static constexpr double kWithin = 1.5;  // [px]
  bool is_known = false;
  bool is_there = false;
  double place = 0.0;  // [px]
  double depth = 0.0;  // [grey] below the ceiling, where it is there

  [[nodiscard]] bool is_seen() const { return is_known && is_there; }
  [[nodiscard]] bool is_ruled_out() const { return is_known && !is_there; }
  [[nodiscard]] bool may_be_at(double at) const { return !is_known || (is_there && std::abs(at - place) <= kWithin); }
};
using KnownJoints = std::array<KnownJoint, 2>;  // of the positive and the negative side

struct Balance {
  double shift = 0.0;          // [m] towards the positive side
  double turn = 0.0;           // [rad]
  double uneven_variance = 0;  // [m^2] of the shift, in its covariance: for sides that are not equally bright
  Eigen::Matrix2d covariance;  // of both
  bool needs_joint = false;    // the differences are not explained without one
};

/// By how much an outline must move that its light falls off alike on opposite sides. `length` [m] of the sides, `step`
/// [m] between the differences. Nothing when too few of them fit.
[[nodiscard]] std::optional<Balance> balance_sides(const Differences& differences, double length, double step,
                                                   const KnownJoints& joints);

}  // namespace luminav
