#include "services/detector/grey_counts.hpp"

#include <algorithm>
#include <array>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

constexpr std::size_t kLanes = 32;
constexpr std::size_t kMostInAByte = 255;

}  // namespace

LUMINAV_VECTOR_CLONES
int count_up_to(const std::uint8_t* grey, std::size_t count, std::uint8_t level) {
  int total = 0;
  std::size_t i = 0;
  while (i + kLanes <= count) {
    alignas(32) std::array<std::uint8_t, kLanes> sums{};
    const std::size_t end = std::min(count - count % kLanes, i + kMostInAByte * kLanes);
    for (; i < end; i += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        sums[lane] = static_cast<std::uint8_t>(sums[lane] + (grey[i + lane] <= level ? 1 : 0));
      }
    }
    for (const std::uint8_t sum : sums) {
      total += sum;
    }
  }
  for (; i < count; ++i) {
    total += grey[i] <= level ? 1 : 0;
  }
  return total;
}

LUMINAV_VECTOR_CLONES
int count_thirds_up_to(const std::uint8_t* grey, std::size_t count, std::uint8_t level) {
  alignas(32) std::array<std::uint8_t, kLanes + 2> wanted{};
  for (std::size_t k = 1; k < wanted.size(); k += 3) {
    wanted[k] = 1;
  }
  int total = 0;
  std::size_t i = 0;
  while (i + kLanes <= count) {
    alignas(32) std::array<std::uint8_t, kLanes> sums{};
    const std::size_t end = std::min(count - count % kLanes, i + kMostInAByte * kLanes);
    for (; i < end; i += kLanes) {
      const std::uint8_t* one = wanted.data() + i % 3;
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        sums[lane] = static_cast<std::uint8_t>(sums[lane] + ((grey[i + lane] <= level ? 1 : 0) & one[lane]));
      }
    }
    for (const std::uint8_t sum : sums) {
      total += sum;
    }
  }
  for (; i < count; ++i) {
    total += i % 3 == 1 && grey[i] <= level ? 1 : 0;
  }
  return total;
}

}  // namespace luminav
