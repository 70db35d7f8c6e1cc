#pragma once

#include <array>
#include <cstddef>

#include "services/detector/opposite_sides.hpp"

namespace luminav {

/// Four numbers that one instruction works on, where the processor can.
using FourDoubles [[gnu::vector_size(4 * sizeof(double))]] = double;

/// What the differences between opposite sides are explained with, by distance from the sides; alike all along them.
struct RegressionSamples {
  static constexpr std::size_t kCount = 16;  // the distances, and one to fill the vectors
  static_assert(Differences::kDistances <= static_cast<int>(kCount));

  alignas(32) std::array<double, kCount> fall{};       // [grey] by which a shift of one pixel changes the difference
  alignas(32) std::array<double, kCount> outwards{};   // -0.5 to 0.5
  alignas(32) std::array<double, kCount> joint{};      // its profile, 1 high
  alignas(32) std::array<double, kCount> precision{};  // [1/grey^2]
  std::array<FourDoubles, kCount> row{};               // of the regression: fall, 1, outwards, joint

  /// After fall and joint were set.
  void fill_rows();
};

/// Normal equations of six unknowns: the factors of fall, 1, outwards, joint, fall x place, place.
struct RegressionSums {
  std::array<FourDoubles, 4> information{};  // columns of the first four with each other
  std::array<FourDoubles, 2> along{};        // of the first four with the fifth, the sixth
  std::array<FourDoubles, 2> corner{};       // of the last two with each other: the first two numbers of each
  FourDoubles right_side{};                  // of the first four
  FourDoubles right_side_along{};            // of the last two: the first two numbers
  double weights = 0.0;

  /// Adds the differences of one stretch, whose place is a share of the length. Tukey's weights by the residuals of
  /// `solution`.
  void add_stretch(const RegressionSamples& samples, const float* values, const bool* valid, double place,
                   const double* solution, double cutoff);
};

/// Normal equations of the first four unknowns, for one value at each distance.
struct MedianSums {
  std::array<FourDoubles, 4> information{};  // columns
  FourDoubles right_side{};
  double cost = 0.0;  // robust, by the solution before

  /// Geman and McClure's weights by the residuals of `solution`; `first`: none.
  void add(const RegressionSamples& samples, const std::array<double, RegressionSamples::kCount>& medians,
           const std::array<bool, RegressionSamples::kCount>& valid, const double* solution, double cutoff, bool first);
};

/// Sorts the values of all stretches, at every distance for itself; those that are not valid come last.
using SortedStretches =
    std::array<std::array<float, RegressionSamples::kCount>, static_cast<std::size_t>(Differences::kStretches)>;
void sort_stretches(const Differences& differences, SortedStretches& sorted);

}  // namespace luminav
