#include "services/detector/regression_sums.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

constexpr std::size_t kCount = RegressionSamples::kCount;
constexpr std::size_t kDistances = Differences::kDistances;
constexpr std::size_t kStretches = Differences::kStretches;

/// All of a side at once, and then all the sums at once.
LUMINAV_VECTOR_CLONES
void add_to(RegressionSums& result, const RegressionSamples& samples, const float* values, const bool* valid,
            double place, const double* solution, double cutoff, bool complete) {
  alignas(32) std::array<double, kCount> value{};
  for (std::size_t k = 0; k < kDistances; ++k) {
    value[k] = values[k];
  }
  alignas(32) std::array<double, kCount> tukey;
  alignas(32) std::array<double, kCount> weight;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double fall = samples.fall[k];
    const double predicted = (fall * solution[0] + (samples.outwards[k] * solution[2] + fall * place * solution[4])) +
                             (solution[1] + (samples.joint[k] * solution[3] + place * solution[5]));
    const double residual = value[k] - predicted;
    const double squared = residual * residual / (cutoff * cutoff * samples.variance[k]);
    const double rest = 1.0 - squared;
    tukey[k] = squared >= 1.0 ? 0.0 : rest * rest;
    weight[k] = tukey[k] / samples.variance[k];
  }
  RegressionSums sums = result;
  for (std::size_t k = 0; k < kDistances; ++k) {
    if (!valid[k]) {
      continue;
    }
    const FourDoubles row = samples.row[k];
    const FourDoubles weighted = weight[k] * row;
    for (std::size_t j = 0; j < 4; ++j) {
      sums.information[j] += weighted * row[j];
    }
    const FourDoubles along = samples.by_turns[k] * place;
    const FourDoubles weighted_along = weight[k] * along;
    sums.below[0] += weighted_along * samples.first_pair[k];
    sums.below[1] += weighted_along * samples.second_pair[k];
    sums.corner += weighted_along * (samples.first_pair[k] * place);
    const double height = weight[k] * value[k];
    sums.right_side += height * row;
    sums.right_side_along += height * along;
    sums.weights += tukey[k];
  }
  if (complete) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      if (valid[k]) {
        const FourDoubles weighted = weight[k] * samples.row[k];
        const FourDoubles along = samples.by_turns[k] * place;
        sums.above[0] += weighted * along[0];
        sums.above[1] += weighted * along[1];
      }
    }
  }
  result = sums;
}

LUMINAV_VECTOR_CLONES
void add_medians_to(MedianSums& result, const RegressionSamples& samples, const double* medians, const bool* valid,
                    const double* solution, double cutoff, bool first) {
  alignas(32) std::array<double, kCount> weight;
  alignas(32) std::array<double, kCount> cost;
  const double squared_cutoff = cutoff * cutoff;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double predicted = (samples.fall[k] * solution[0] + samples.outwards[k] * solution[2]) +
                             (solution[1] + samples.joint[k] * solution[3]);
    const double residual = medians[k] - predicted;
    const double squared = residual * residual / (squared_cutoff * samples.variance[k]);
    // Geman and McClure's weight: it has a slope everywhere
    weight[k] = (first ? 1.0 : 1.0 / ((1.0 + squared) * (1.0 + squared))) / samples.variance[k];
    cost[k] = squared_cutoff * squared / (1.0 + squared);
  }
  MedianSums sums = result;
  for (std::size_t k = 0; k < kDistances; ++k) {
    if (!valid[k]) {
      continue;
    }
    const FourDoubles row = samples.row[k];
    const FourDoubles weighted = weight[k] * row;
    for (std::size_t j = 0; j < 4; ++j) {
      sums.information[j] += weighted * row[j];
    }
    sums.right_side += weight[k] * medians[k] * row;
    sums.cost += cost[k];
  }
  result = sums;
}

/// A sorting network of the least comparisons for eight (Floyd and Knuth 1970).
LUMINAV_VECTOR_CLONES
void sort_each(SortedStretches& rows) {
  static_assert(kStretches == 8);
  constexpr std::array<std::pair<std::size_t, std::size_t>, 19> kComparisons{{{0, 2},
                                                                              {1, 3},
                                                                              {4, 6},
                                                                              {5, 7},
                                                                              {0, 4},
                                                                              {1, 5},
                                                                              {2, 6},
                                                                              {3, 7},
                                                                              {0, 1},
                                                                              {2, 3},
                                                                              {4, 5},
                                                                              {6, 7},
                                                                              {2, 4},
                                                                              {3, 5},
                                                                              {1, 4},
                                                                              {3, 6},
                                                                              {1, 2},
                                                                              {3, 4},
                                                                              {5, 6}}};
  for (const auto& [low, high] : kComparisons) {
    float* a = rows[low].data();
    float* b = rows[high].data();
#pragma GCC ivdep
    for (std::size_t k = 0; k < kCount; ++k) {
      const float x = a[k];
      const float y = b[k];
      a[k] = y < x ? y : x;
      b[k] = y < x ? x : y;
    }
  }
}

}  // namespace

void RegressionSamples::fill_rows() {
  for (std::size_t k = 0; k < kCount; ++k) {
    row[k] = FourDoubles{fall[k], 1.0, outwards[k], joint[k]};
    first_pair[k] = FourDoubles{fall[k], fall[k], 1.0, 1.0};
    second_pair[k] = FourDoubles{outwards[k], outwards[k], joint[k], joint[k]};
    by_turns[k] = FourDoubles{fall[k], 1.0, fall[k], 1.0};
  }
}

void RegressionSums::add_stretch(const RegressionSamples& samples, const float* values, const bool* valid, double place,
                                 const double* solution, double cutoff, bool complete) {
  add_to(*this, samples, values, valid, place, solution, cutoff, complete);
}

void MedianSums::add(const RegressionSamples& samples, const std::array<double, kCount>& medians,
                     const std::array<bool, kCount>& valid, const double* solution, double cutoff, bool first) {
  add_medians_to(*this, samples, medians.data(), valid.data(), solution, cutoff, first);
}

void sort_stretches(const Differences& differences, SortedStretches& sorted) {
  for (std::size_t s = 0; s < kStretches; ++s) {
    sorted[s].fill(std::numeric_limits<float>::infinity());
    for (std::size_t k = 0; k < kDistances; ++k) {
      if (differences.valid[s][k]) {
        sorted[s][k] = differences.value[s][k];
      }
    }
  }
  sort_each(sorted);
}

}  // namespace luminav
