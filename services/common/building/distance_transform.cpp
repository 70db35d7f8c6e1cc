#include "services/common/building/distance_transform.hpp"

#include <algorithm>
#include <limits>

namespace luminav {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();  // and one more is the same

/// Squared distances to the nearest solid cell of the same column: down all rows, then up.
std::vector<float> along_columns(const std::vector<bool>& is_solid, std::size_t columns) {
  std::vector<float> distances(is_solid.size());
  const std::size_t size = distances.size();
  for (std::size_t i = 0; i < size; ++i) {
    distances[i] = is_solid[i] ? 0.0F : i < columns ? kNone : distances[i - columns] + 1.0F;
  }
  for (std::size_t i = size; i-- > 0;) {
    if (i + columns < size) {
      distances[i] = std::min(distances[i], distances[i + columns] + 1.0F);
    }
  }
  for (float& distance : distances) {
    distance = distance < kNone ? distance * distance : kNoSolidCell;
  }
  return distances;
}

/// Transforms lines of one length: lower envelope of the parabolas f[q] + (p - q)^2.
class LineTransform {
 public:
  explicit LineTransform(std::size_t length) : f_(length), apexes_(length), bounds_(length + 1) {}

  void run(float* values) {
    for (std::size_t q = 0; q < f_.size(); ++q) {
      f_[q] = static_cast<double>(values[q]);
    }
    find_envelope();
    std::size_t k = 0;
    for (std::size_t p = 0; p < f_.size(); ++p) {
      while (bounds_[k + 1] < static_cast<double>(p)) {
        ++k;
      }
      const double offset = static_cast<double>(p) - static_cast<double>(apexes_[k]);
      values[p] = static_cast<float>(f_[apexes_[k]] + offset * offset);
    }
  }

 private:
  void find_envelope() {
    std::size_t last = 0;
    apexes_[0] = 0;
    bounds_[0] = -std::numeric_limits<double>::infinity();
    bounds_[1] = std::numeric_limits<double>::infinity();
    for (std::size_t q = 1; q < f_.size(); ++q) {
      double bound = intersection(q, apexes_[last]);
      while (bound <= bounds_[last]) {
        bound = intersection(q, apexes_[--last]);
      }
      apexes_[++last] = q;
      bounds_[last] = bound;
      bounds_[last + 1] = std::numeric_limits<double>::infinity();
    }
  }
  [[nodiscard]] double intersection(std::size_t q, std::size_t v) const {
    const auto dq = static_cast<double>(q);
    const auto dv = static_cast<double>(v);
    return ((f_[q] + dq * dq) - (f_[v] + dv * dv)) / (2.0 * (dq - dv));
  }

  std::vector<double> f_;
  std::vector<std::size_t> apexes_;
  std::vector<double> bounds_;
};

}  // namespace

std::vector<float> squared_distances_to(const std::vector<bool>& is_solid, std::size_t columns) {
  std::vector<float> squared = along_columns(is_solid, columns);
  LineTransform along_row(columns);
  for (std::size_t i = 0; i < squared.size(); i += columns) {
    along_row.run(squared.data() + i);
  }
  return squared;
}

}  // namespace luminav
