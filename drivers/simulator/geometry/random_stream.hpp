#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "services/common/geometry/angle.hpp"

namespace luminav {

/// Next value of a splitmix64 generator (Steele, Lea and Flood 2014); advances the state.
inline std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Uniform in [0, 1).
inline double next_uniform(std::uint64_t& state) {
  return static_cast<double>(next_random(state) >> 11) * 0x1.0p-53;
}

/// Random numbers for one purpose. Streams of the same seed but of another purpose or index are independent, so that
/// one more person in a scenario leaves the camera's tilt as it was.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view purpose, std::uint64_t index = 0) : state_(seed) {
    for (const char letter : purpose) {
      state_ = next_random(state_) ^ static_cast<unsigned char>(letter);
    }
    state_ = next_random(state_) ^ index;
    next_random(state_);
  }

  /// In [0, 1).
  double uniform() { return next_uniform(state_); }
  double uniform(double min, double max) { return min + (max - min) * uniform(); }
  bool happens(double probability) { return uniform() < probability; }
  /// In [0, count).
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(uniform() * static_cast<double>(count)); }

  /// Box and Muller; the second value of each pair is thrown away, so that every draw costs the stream the same.
  double gaussian(double sigma) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return sigma * radius * std::cos(2.0 * kPi * uniform());
  }

  /// The generator's bare state, for functions that take it.
  std::uint64_t& state() { return state_; }

 private:
  std::uint64_t state_;
};

}  // namespace luminav
