#include "drivers/simulator/geometry/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {
namespace {

constexpr double kNone = 1e12;  // squared cells; stands for "no solid cell"

/// Squared distances along one line: lower envelope of the parabolas f[q] + (p - q)^2.
class LineTransform {
 public:
  explicit LineTransform(std::size_t length) : f(length), apexes_(length), bounds_(length + 1) {}

  void run() {
    std::size_t last = 0;
    apexes_[0] = 0;
    bounds_[0] = -std::numeric_limits<double>::infinity();
    bounds_[1] = std::numeric_limits<double>::infinity();
    for (std::size_t q = 1; q < f.size(); ++q) {
      double bound = intersection(q, apexes_[last]);
      while (bound <= bounds_[last]) {
        bound = intersection(q, apexes_[--last]);
      }
      apexes_[++last] = q;
      bounds_[last] = bound;
      bounds_[last + 1] = std::numeric_limits<double>::infinity();
    }
    result.resize(f.size());
    std::size_t k = 0;
    for (std::size_t p = 0; p < f.size(); ++p) {
      while (bounds_[k + 1] < static_cast<double>(p)) {
        ++k;
      }
      const double offset = static_cast<double>(p) - static_cast<double>(apexes_[k]);
      result[p] = f[apexes_[k]] + offset * offset;
    }
  }

  std::vector<double> f;
  std::vector<double> result;

 private:
  [[nodiscard]] double intersection(std::size_t q, std::size_t v) const {
    const auto dq = static_cast<double>(q);
    const auto dv = static_cast<double>(v);
    return ((f[q] + dq * dq) - (f[v] + dv * dv)) / (2.0 * (dq - dv));
  }

  std::vector<std::size_t> apexes_;
  std::vector<double> bounds_;
};

}  // namespace

DistanceField::DistanceField(const GridGeometry& geometry, const std::vector<bool>& is_solid, bool beyond)
    : geometry_(geometry), beyond_(beyond ? 0.0 : kFar) {
  // A frame of one cell round the grid stands for what is outside.
  const auto columns = static_cast<std::size_t>(geometry.columns) + 2;
  const auto rows = static_cast<std::size_t>(geometry.rows) + 2;
  std::vector<float> squared(columns * rows, static_cast<float>(beyond ? 0.0 : kNone));
  for (std::size_t row = 1; row + 1 < rows; ++row) {
    for (std::size_t column = 1; column + 1 < columns; ++column) {
      const std::size_t source = (row - 1) * (columns - 2) + column - 1;
      squared[row * columns + column] = static_cast<float>(is_solid[source] ? 0.0 : kNone);
    }
  }
  LineTransform along_column(rows);
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t row = 0; row < rows; ++row) {
      along_column.f[row] = squared[row * columns + column];
    }
    along_column.run();
    for (std::size_t row = 0; row < rows; ++row) {
      squared[row * columns + column] = static_cast<float>(along_column.result[row]);
    }
  }
  LineTransform along_row(columns);
  distances_.resize(geometry.size());
  for (std::size_t row = 1; row + 1 < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      along_row.f[column] = squared[row * columns + column];
    }
    along_row.run();
    for (std::size_t column = 1; column + 1 < columns; ++column) {
      const double cells = std::sqrt(along_row.result[column]);
      const double metres = std::clamp((cells - 0.5) * geometry.resolution, 0.0, kFar);
      distances_[(row - 1) * (columns - 2) + column - 1] = static_cast<float>(metres);
    }
  }
}

DistanceField distance_to_walls(const PriorMap& map) {
  std::vector<bool> solid(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), solid.begin(),
                 [](Prior cell) { return cell == Prior::kOccupied; });
  return {map.geometry, solid, false};
}

DistanceField distance_to_not_free(const PriorMap& map) {
  std::vector<bool> solid(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), solid.begin(), [](Prior cell) { return cell != Prior::kFree; });
  return {map.geometry, solid, true};
}

}  // namespace luminav
