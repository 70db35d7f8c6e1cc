#include "tests/unit/planner/office_grid.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/split_mix.hpp"

namespace luminav {
namespace {

class Canvas {
 public:
  Canvas(int side, double resolution)
      : side_(side),
        resolution_(resolution),
        cells_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0) {}
  void fill(double x0, double y0, double x1, double y1, std::uint8_t value) {
    for (int row = cell(y0); row < cell(y1); ++row) {
      for (int column = cell(x0); column < cell(x1); ++column) {
        cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(column)] =
            value;
      }
    }
  }
  std::vector<std::uint8_t> take() { return std::move(cells_); }

 private:
  [[nodiscard]] int cell(double metres) const {
    return std::clamp(static_cast<int>(std::lround(metres / resolution_)), 0, side_);
  }
  int side_;
  double resolution_;
  std::vector<std::uint8_t> cells_;
};

}  // namespace

std::vector<std::uint8_t> office_grid(int side, double resolution) {
  const double size = side * resolution;
  constexpr double kWall = 0.2;  // [m]
  SplitMix draw(1);
  Canvas canvas(side, resolution);
  for (double by = 2.0; by < size; by += 12.0) {
    for (double bx = 2.0; bx < size; bx += 22.0) {
      for (int row = 0; row < 2; ++row) {
        for (int k = 0; k < 5; ++k) {
          const double x0 = bx + 4.0 * k;
          const double y0 = by + 5.0 * row;
          const double x1 = x0 + 4.0;
          const double y1 = y0 + 5.0;
          const double door = draw.uniform(0.4, 2.6);
          double fx[2];
          double fy[2];
          for (int i = 0; i < 2; ++i) {
            fx[i] = draw.uniform(0.3, 2.9);
            fy[i] = draw.uniform(1.2, 3.9);
          }
          if (x1 > size - 2.0 || y1 > size - 2.0) {
            continue;
          }
          canvas.fill(x0, y0, x1, y0 + kWall, 1);
          canvas.fill(x0, y1 - kWall, x1, y1, 1);
          canvas.fill(x0, y0, x0 + kWall, y1, 1);
          canvas.fill(x1 - kWall, y0, x1, y1, 1);
          const double door_y = row == 0 ? y0 : y1 - kWall;
          canvas.fill(x0 + door, door_y, x0 + door + 0.9, door_y + kWall, 0);
          for (int i = 0; i < 2; ++i) {
            const double y = row == 0 ? y0 + fy[i] : y1 - fy[i] - 0.6;
            canvas.fill(x0 + fx[i], y, x0 + fx[i] + 0.8, y + 0.6, 1);
          }
        }
      }
    }
  }
  canvas.fill(0.0, 0.0, size, kWall, 1);
  canvas.fill(0.0, size - kWall, size, size, 1);
  canvas.fill(0.0, 0.0, kWall, size, 1);
  canvas.fill(size - kWall, 0.0, size, size, 1);
  return canvas.take();
}

std::uint64_t fnv1a(const std::vector<std::uint8_t>& bytes) {
  std::uint64_t hash = 1469598103934665603ULL;
  for (const std::uint8_t byte : bytes) {
    hash = (hash ^ byte) * 1099511628211ULL;
  }
  return hash;
}

}  // namespace luminav
