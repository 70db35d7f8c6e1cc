#pragma once

#include <cmath>
#include <cstdint>

#include "services/common/geometry/angle.hpp"

namespace luminav::simulated {

/// splitmix64 (Steele et al. 2014): tiny, seedable anywhere, the same on every machine.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  /// [0, 1)
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  double uniform(double min, double max) { return min + (max - min) * uniform(); }
  /// Mean 0, deviation 1; Box and Muller 1958.
  double gauss() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * kPi * uniform());
  }

 private:
  std::uint64_t state_;
};

/// A stream of its own for each (seed, purpose, number).
inline RandomStream random_stream(std::uint64_t seed, std::uint64_t purpose, std::uint64_t number) {
  RandomStream mix(seed ^ (purpose * 0xD1B54A32D192ED03ULL));
  return RandomStream(mix.next() + number * 0x8CB92BA72F3D8DD7ULL);
}

}  // namespace luminav::simulated
