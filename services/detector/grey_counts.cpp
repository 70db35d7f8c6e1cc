#include "services/detector/grey_counts.hpp"

#include <algorithm>
#include <array>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

constexpr std::size_t kLanes = 32;
constexpr std::size_t kMostInAByte = 255;

/// Of those that `wanted` says 1 for; it repeats itself every three.
template <typename Wanted>
[[gnu::always_inline]] inline int count_wanted(const std::uint8_t* grey, std::size_t count, std::uint8_t level,
                                               Wanted wanted) {
  int total = 0;
  std::size_t i = 0;
  while (i + kLanes <= count) {
    alignas(32) std::array<std::uint8_t, kLanes> sums{};
    const std::size_t end = std::min(count - count % kLanes, i + kMostInAByte * kLanes);
    for (; i < end; i += kLanes) {
      const std::size_t phase = i % 3;
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        sums[lane] = static_cast<std::uint8_t>(sums[lane] + ((grey[i + lane] <= level ? 1 : 0) & wanted(phase + lane)));
      }
    }
    for (const std::uint8_t sum : sums) {
      total += sum;
    }
  }
  for (; i < count; ++i) {
    total += (grey[i] <= level ? 1 : 0) & wanted(i % 3);
  }
  return total;
}

}  // namespace

LUMINAV_VECTOR_CLONES
int count_up_to(const std::uint8_t* grey, std::size_t count, std::uint8_t level) {
  return count_wanted(grey, count, level, [](std::size_t) { return 1; });
}

LUMINAV_VECTOR_CLONES
int count_thirds_up_to(const std::uint8_t* grey, std::size_t count, std::uint8_t level) {
  alignas(32) std::array<std::uint8_t, kLanes + 2> second_of_three{};
  for (std::size_t k = 1; k < second_of_three.size(); k += 3) {
    second_of_three[k] = 1;
  }
  return count_wanted(grey, count, level, [&](std::size_t at) { return second_of_three[at]; });
}

}  // namespace luminav
