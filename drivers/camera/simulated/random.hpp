#pragma once

#include "services/common/geometry/split_mix.hpp"

namespace luminav::simulated {

/// A stream of its own for each (seed, purpose, number).
inline SplitMix random_stream(std::uint64_t seed, std::uint64_t purpose, std::uint64_t number) {
  SplitMix mix(seed ^ (purpose * 0xD1B54A32D192ED03ULL));
  return SplitMix(mix.next() + number * 0x8CB92BA72F3D8DD7ULL);
}

}  // namespace luminav::simulated
