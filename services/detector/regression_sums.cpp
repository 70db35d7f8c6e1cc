#include "services/detector/regression_sums.hpp"

#include <algorithm>
#include <limits>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/column_sort.hpp"

namespace luminav {
namespace {

constexpr std::size_t kCount = RegressionSamples::kCount;
constexpr std::size_t kDistances = Differences::kDistances;
constexpr std::size_t kStretches = Differences::kStretches;

/// Sums over one value at each distance.
struct DistanceSums {
  std::array<FourDoubles, 4> information;
  FourDoubles right_side;
};

// A function of its own, not one that is put into others: the compiler takes wide numbers apart before it does that.
LUMINAV_VECTOR_CLONES
void add_up(const RegressionSamples& samples, const double* values, const double* weight, DistanceSums& result) {
  DistanceSums sums{};
  for (std::size_t k = 0; k < kDistances; ++k) {
    const FourDoubles row = samples.row[k];
    const FourDoubles weighted = weight[k] * row;
    for (std::size_t j = 0; j < 4; ++j) {
      sums.information[j] += weighted * row[j];
    }
    sums.right_side += values[k] * weighted;
  }
  result = sums;
}

/// Along a stretch the place is the same, so what the unknowns along the sides add is a multiple of the rest.
LUMINAV_VECTOR_CLONES
void add_to(RegressionSums& result, const RegressionSamples& samples, const float* values, const bool* valid,
            double place, const double* solution, double cutoff) {
  alignas(32) std::array<double, kCount> value{};
  alignas(32) std::array<double, kCount> is_valid{};
  for (std::size_t k = 0; k < kDistances; ++k) {
    value[k] = values[k];
    is_valid[k] = valid[k] ? 1.0 : 0.0;
  }
  const double per_fall = solution[0] + place * solution[4];
  const double constant = solution[1] + place * solution[5];
  const double per_cutoff = 1.0 / (cutoff * cutoff);
  alignas(32) std::array<double, kCount> tukey;
  alignas(32) std::array<double, kCount> weight;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double predicted =
        (samples.fall[k] * per_fall + samples.outwards[k] * solution[2]) + (constant + samples.joint[k] * solution[3]);
    const double residual = value[k] - predicted;
    const double rest = 1.0 - residual * residual * per_cutoff * samples.precision[k];
    tukey[k] = (rest <= 0.0 ? 0.0 : rest * rest) * is_valid[k];
    weight[k] = tukey[k] * samples.precision[k];
  }
  DistanceSums sums;
  add_up(samples, value.data(), weight.data(), sums);
  for (std::size_t j = 0; j < 4; ++j) {
    result.information[j] += sums.information[j];
  }
  for (std::size_t j = 0; j < 2; ++j) {
    result.along[j] += place * sums.information[j];
    result.corner[j] += place * place * sums.information[j];
  }
  result.right_side += sums.right_side;
  result.right_side_along += place * sums.right_side;
  for (std::size_t k = 0; k < kDistances; ++k) {
    result.weights += tukey[k];
  }
}

LUMINAV_VECTOR_CLONES
void add_medians_to(MedianSums& result, const RegressionSamples& samples, const double* medians, const bool* valid,
                    const double* solution, double cutoff, bool first) {
  alignas(32) std::array<double, kCount> is_valid{};
  for (std::size_t k = 0; k < kDistances; ++k) {
    is_valid[k] = valid[k] ? 1.0 : 0.0;
  }
  alignas(32) std::array<double, kCount> weight;
  alignas(32) std::array<double, kCount> cost;
  const double squared_cutoff = cutoff * cutoff;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double predicted = (samples.fall[k] * solution[0] + samples.outwards[k] * solution[2]) +
                             (solution[1] + samples.joint[k] * solution[3]);
    const double residual = medians[k] - predicted;
    const double squared = residual * residual * samples.precision[k];
    // Geman and McClure's weight: it has a slope everywhere
    const double share = squared_cutoff / (squared_cutoff + squared);
    weight[k] = (first ? 1.0 : share * share) * samples.precision[k] * is_valid[k];
    cost[k] = squared * share * is_valid[k];
  }
  DistanceSums sums;
  add_up(samples, medians, weight.data(), sums);
  for (std::size_t j = 0; j < 4; ++j) {
    result.information[j] += sums.information[j];
  }
  result.right_side += sums.right_side;
  for (std::size_t k = 0; k < kDistances; ++k) {
    result.cost += cost[k];
  }
}

}  // namespace

void RegressionSamples::fill_rows() {
  for (std::size_t k = 0; k < kCount; ++k) {
    row[k] = FourDoubles{fall[k], 1.0, outwards[k], joint[k]};
  }
}

void RegressionSums::add_stretch(const RegressionSamples& samples, const float* values, const bool* valid, double place,
                                 const double* solution, double cutoff) {
  add_to(*this, samples, values, valid, place, solution, cutoff);
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
  sort_columns(sorted);
}

}  // namespace luminav
