#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <vector>

namespace luminav {

/// Some numbers that are reckoned with at once.
inline constexpr std::size_t kLanes = 4;
using Doubles = double __attribute__((vector_size(kLanes * sizeof(double))));
inline void load(const double* from, Doubles& lanes) {
  std::memcpy(&lanes, from, sizeof(lanes));
}

/// Points of a plane [m], their coordinates in arrays of their own: a pass over them takes several at once.
class PlanePoints {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const double* x() const { return x_.data(); }
  [[nodiscard]] const double* y() const { return y_.data(); }
  [[nodiscard]] Eigen::Vector2d operator[](std::size_t i) const { return {x_[i], y_[i]}; }

  void clear() { size_ = 0; }
  /// Room for this many; what was made once is kept. Behind the last there are numbers for whole lanes.
  void reserve(std::size_t size) {
    const std::size_t whole = size + kLanes;
    if (x_.size() < whole) {
      x_.resize(whole);
      y_.resize(whole);
    }
  }
  /// There must be room for it.
  void add(const Eigen::Vector2d& point) {
    x_[size_] = point.x();
    y_[size_++] = point.y();
  }
  /// There must be room for them.
  void add(const PlanePoints& points) {
    std::copy_n(points.x_.begin(), points.size_, x_.begin() + static_cast<std::ptrdiff_t>(size_));
    std::copy_n(points.y_.begin(), points.size_, y_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += points.size_;
  }
  /// Adds (x[i], y[i]) + offset for each i below `count`. There must be room for them, and numbers in `x` and `y` up to
  /// a multiple of `kLanes`.
  void add_shifted(const double* x, const double* y, std::size_t count, const Eigen::Vector2d& offset) {
    double* const to_x = x_.data() + size_;
    double* const to_y = y_.data() + size_;
    for (std::size_t i = 0; i < count; i += kLanes) {
      Doubles some_x;
      Doubles some_y;
      load(x + i, some_x);
      load(y + i, some_y);
      some_x += offset.x();
      some_y += offset.y();
      std::memcpy(to_x + i, &some_x, sizeof(some_x));
      std::memcpy(to_y + i, &some_y, sizeof(some_y));
    }
    size_ += count;
  }
  /// Makes points infinitely far away of the numbers behind the last one, up to whole lanes.
  void fill_last_lanes() {
    for (std::size_t i = size_; i % kLanes != 0; ++i) {
      x_[i] = y_[i] = std::numeric_limits<double>::infinity();
    }
  }

 private:
  std::size_t size_ = 0;
  std::vector<double> x_;  // as many as there ever was room for
  std::vector<double> y_;
};

}  // namespace luminav
