#pragma once

#include <cstdint>
#include <string_view>

#include "services/common/geometry/split_mix.hpp"

namespace luminav {

/// Random numbers for one purpose. Streams of the same seed but of another purpose or index are independent, so that
/// one more person in a scenario leaves the camera's tilt as it was.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view purpose, std::uint64_t index = 0) : generator_(seed) {
    for (const char letter : purpose) {
      generator_ = SplitMix(generator_.next() ^ static_cast<unsigned char>(letter));
    }
    generator_ = SplitMix(generator_.next() ^ index);
    generator_.next();
  }

  /// In [0, 1).
  double uniform() { return generator_.uniform(); }
  double uniform(double min, double max) { return generator_.uniform(min, max); }
  bool happens(double probability) { return uniform() < probability; }
  /// In [0, count).
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(uniform() * static_cast<double>(count)); }

  /// Mean 0.
  double gaussian(double sigma) { return generator_.gauss(sigma); }

  /// For functions that take the bare generator.
  SplitMix& generator() { return generator_; }

 private:
  SplitMix generator_;
};

}  // namespace luminav
