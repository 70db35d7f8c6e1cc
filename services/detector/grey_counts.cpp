#include "services/detector/grey_counts.hpp"

#include <algorithm>
#include <array>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

constexpr std::size_t kLanes = 32;
constexpr std::size_t kMostInAByte = 255;

/// Of those for which `wanted` has a 1; it is as long as `kBlock` and then begins again.
template <std::size_t kBlock>
[[gnu::always_inline]] inline int count_wanted(const std::uint8_t* grey, std::size_t count, std::uint8_t level,
                                               const std::array<std::uint8_t, kBlock>& wanted) {
  static_assert(kBlock % kLanes == 0);
  int total = 0;
  std::size_t i = 0;
  const auto add_up = [&](const auto& sums) {
    for (const std::uint8_t sum : sums) {
      total += sum;
    }
  };
  while (i + kBlock <= count) {
    alignas(32) std::array<std::uint8_t, kBlock> sums{};
    const std::size_t end = std::min(count - count % kBlock, i + kMostInAByte * kBlock);
    for (; i < end; i += kBlock) {
      for (std::size_t lane = 0; lane < kBlock; ++lane) {
        sums[lane] = static_cast<std::uint8_t>(sums[lane] + ((grey[i + lane] <= level ? 1 : 0) & wanted[lane]));
      }
    }
    add_up(sums);
  }
  std::size_t phase = 0;
  if (i + kLanes <= count) {
    alignas(32) std::array<std::uint8_t, kLanes> sums{};
    for (; i + kLanes <= count; i += kLanes, phase += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        sums[lane] = static_cast<std::uint8_t>(sums[lane] + ((grey[i + lane] <= level ? 1 : 0) & wanted[phase + lane]));
      }
    }
    add_up(sums);
  }
  for (; i < count; ++i, ++phase) {
    total += (grey[i] <= level ? 1 : 0) & wanted[phase];
  }
  return total;
}

template <std::size_t kBlock>
constexpr std::array<std::uint8_t, kBlock> every(std::size_t nth, std::size_t first) {
  std::array<std::uint8_t, kBlock> wanted{};
  for (std::size_t k = first; k < kBlock; k += nth) {
    wanted[k] = 1;
  }
  return wanted;
}

}  // namespace

LUMINAV_VECTOR_CLONES
int count_up_to(const std::uint8_t* grey, std::size_t count, std::uint8_t level) {
  static constexpr auto kAll = every<4 * kLanes>(1, 0);
  return count_wanted(grey, count, level, kAll);
}

LUMINAV_VECTOR_CLONES
int count_thirds_up_to(const std::uint8_t* grey, std::size_t count, std::uint8_t level) {
  alignas(32) static constexpr auto kThirds = every<3 * kLanes>(3, 1);
  return count_wanted(grey, count, level, kThirds);
}

}  // namespace luminav
