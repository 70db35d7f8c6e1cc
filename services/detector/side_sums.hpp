#pragma once

#include <Eigen/Core>

#include "services/detector/outline.hpp"

namespace luminav {

/// Normal equations of what moves an outline onto its edges: along, across, theta, swelling, taper.
struct OutlineEquations {
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> right_side = Eigen::Matrix<double, 5, 1>::Zero();
};

/// Weighted sums over the edges of one straight side, from which its part of the equations follows at once.
struct SideSums {
  double weights = 0.0;
  double places = 0.0;   // [m] along the side
  double places2 = 0.0;  // [m^2]
  double offsets = 0.0;  // [m] outward
  double places_offsets = 0.0;

  void add(double weight, double place, double offset) {
    const double weighted_place = weight * place;
    weights += weight;
    places += weighted_place;
    places2 += weighted_place * place;
    offsets += weight * offset;
    places_offsets += weighted_place * offset;
  }

  /// `lever` [m]: of the taper in the middle of the side.
  void add_to(OutlineEquations& equations, int side, double lever) const {
    // The equation of an edge at the place c has the coefficients fixed + c * along.
    const double outward = side == kLeftSide || side == kFarEnd ? 1.0 : -1.0;
    Eigen::Matrix<double, 5, 1> fixed;
    Eigen::Matrix<double, 5, 1> along;
    if (side == kLeftSide || side == kRightSide) {
      fixed << 0.0, outward, 0.0, 1.0, lever;
      along << 0.0, 0.0, outward, 0.0, 1.0;
    } else {
      fixed << outward, 0.0, 0.0, 1.0, lever;
      along << 0.0, 0.0, -outward, 0.0, 0.0;
    }
    const Eigen::Matrix<double, 5, 1> mean = weights * fixed + places * along;
    const Eigen::Matrix<double, 5, 1> spread = places * fixed + places2 * along;
    equations.information += fixed * mean.transpose() + along * spread.transpose();
    equations.right_side += offsets * fixed + places_offsets * along;
  }
};

}  // namespace luminav
