#include "services/detector/grey_counts.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

constexpr std::size_t kLanes = 32;
constexpr std::size_t kMostInAByte = 255;

/// Of those for which `wanted` has a 1; it is as long as `kBlock` and in every row begins again.
template <std::size_t kBlock>
[[gnu::always_inline]] inline int count_wanted(const GreyRows& rows, std::uint8_t level,
                                               const std::array<std::uint8_t, kBlock>& wanted) {
  static_assert(kBlock % kLanes == 0);
  int total = 0;
  alignas(32) std::array<std::uint8_t, kBlock> sums{};
  std::size_t most = 0;  // that may be in any of the sums
  const auto make_room = [&] {
    if (++most > kMostInAByte) {
      total = std::accumulate(sums.begin(), sums.end(), total);
      sums.fill(0);
      most = 1;
    }
  };
  for (std::size_t row = 0; row < rows.rows; ++row) {
    const std::uint8_t* grey = rows.first + row * rows.apart;
    std::size_t i = 0;
    for (; i + kBlock <= rows.count; i += kBlock) {
      make_room();
      for (std::size_t lane = 0; lane < kBlock; ++lane) {
        sums[lane] = static_cast<std::uint8_t>(sums[lane] + ((grey[i + lane] <= level ? 1 : 0) & wanted[lane]));
      }
    }
    make_room();
    std::size_t phase = 0;
    for (; i + kLanes <= rows.count; i += kLanes, phase += kLanes) {
      for (std::size_t lane = phase; lane < phase + kLanes; ++lane) {
        sums[lane] = static_cast<std::uint8_t>(sums[lane] + ((grey[i + lane - phase] <= level ? 1 : 0) & wanted[lane]));
      }
    }
    for (; i < rows.count; ++i, ++phase) {
      total += (grey[i] <= level ? 1 : 0) & wanted[phase];
    }
  }
  return std::accumulate(sums.begin(), sums.end(), total);
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
  return count_wanted({grey, count, 1, count}, level, kAll);
}

LUMINAV_VECTOR_CLONES
int count_thirds_up_to(const GreyRows& rows, std::uint8_t level) {
  alignas(32) static constexpr auto kThirds = every<3 * kLanes>(3, 1);
  return count_wanted(rows, level, kThirds);
}

LUMINAV_VECTOR_CLONES
std::uint8_t largest_of(const std::uint8_t* grey, std::size_t count) {
  std::uint8_t most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    most = std::max(most, grey[i]);
  }
  return most;
}

}  // namespace luminav
