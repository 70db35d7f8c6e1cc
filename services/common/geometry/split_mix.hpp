#pragma once

#include <cmath>
#include <cstdint>

#include "services/common/geometry/angle.hpp"

namespace luminav {

/// A small random generator, seedable anywhere, whose numbers are the same on every machine: splitmix64 (Steele, Lea
/// and Flood 2014).
class SplitMix {
 public:
  explicit SplitMix(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double min, double max) { return min + (max - min) * uniform(); }
  /// Mean 0. Box and Muller 1958; the second value of each pair is dropped, so that every draw costs the stream the
  /// same.
  double gauss(double deviation = 1.0) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return deviation * radius * std::cos(2.0 * kPi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace luminav
