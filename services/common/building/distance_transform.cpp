#include "services/common/building/distance_transform.hpp"

#include <limits>

namespace luminav {
namespace {

/// Transforms lines of one length: lower envelope of the parabolas f[q] + (p - q)^2.
class LineTransform {
 public:
  explicit LineTransform(std::size_t length) : f_(length), apexes_(length), bounds_(length + 1) {}

  /// Replaces the values of a line, each `stride` behind the one before.
  void run(float* values, std::size_t stride) {
    for (std::size_t q = 0; q < f_.size(); ++q) {
      f_[q] = static_cast<double>(values[q * stride]);
    }
    find_envelope();
    std::size_t k = 0;
    for (std::size_t p = 0; p < f_.size(); ++p) {
      while (bounds_[k + 1] < static_cast<double>(p)) {
        ++k;
      }
      const double offset = static_cast<double>(p) - static_cast<double>(apexes_[k]);
      values[p * stride] = static_cast<float>(f_[apexes_[k]] + offset * offset);
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
  std::vector<float> squared(is_solid.size());
  for (std::size_t i = 0; i < squared.size(); ++i) {
    squared[i] = is_solid[i] ? 0.0F : kNoSolidCell;
  }
  const std::size_t rows = columns == 0 ? 0 : squared.size() / columns;
  LineTransform along_column(rows);
  for (std::size_t column = 0; column < columns && rows > 0; ++column) {
    along_column.run(squared.data() + column, columns);
  }
  LineTransform along_row(columns);
  for (std::size_t row = 0; row < rows; ++row) {
    along_row.run(squared.data() + row * columns, 1);
  }
  return squared;
}

}  // namespace luminav
