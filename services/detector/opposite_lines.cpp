#include "services/detector/opposite_lines.hpp"

#include <algorithm>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kDistances = Differences::kDistances;
constexpr float kSaturated = 250.0F;

/// Numbers that one instruction works on, where the processor can. The compiler does not find that in `compare`.
constexpr std::size_t kLanes = 8;
using EachFloat [[gnu::vector_size(kLanes * sizeof(float))]] = float;
using EightInMemory [[gnu::vector_size(kLanes * sizeof(float)), gnu::aligned(4), gnu::may_alias]] = float;
using EachInt [[gnu::vector_size(kLanes * sizeof(int))]] = int;

inline const EightInMemory* eight(const float* values) {
  return reinterpret_cast<const EightInMemory*>(values);
}
inline EightInMemory* eight(float* values) {
  return reinterpret_cast<EightInMemory*>(values);
}
static_assert(kNear == kLanes);

constexpr std::array<float, kPadded> count_up() {
  std::array<float, kPadded> steps{};
  for (std::size_t k = 0; k < kPadded; ++k) {
    steps[k] = static_cast<float>(k);
  }
  return steps;
}

/// Adds what the far halves of opposite lines differ by that are all in view; returns of how many. Where the border
/// cuts them off, what is left may be bloom.
LUMINAV_VECTOR_CLONES
std::size_t add_far_differences(const StretchLines& lines, float* sums) {
  std::size_t count = 0;
  for (std::size_t pair = 0; pair < lines.pairs; ++pair) {
    if (lines.in_view[pair] < kDistances) {
      continue;
    }
    ++count;
    const auto* grey = eight(&lines.grey[StretchLines::kHalf + 2 * pair * kNear]);
    const auto* gain = eight(&lines.gain[StretchLines::kHalf + 2 * pair * kNear]);
    *eight(sums) += grey[0] / gain[0] - grey[1] / gain[1];
  }
  return count;
}

}  // namespace

LUMINAV_VECTOR_CLONES
void place_along(const Vector2d& first, const Vector2d& advance, std::size_t last, const Vignetting& lens,
                 std::size_t line, StretchLines& lines) {
  alignas(32) static constexpr std::array<float, kPadded> kSteps = count_up();
  const auto first_x = static_cast<float>(first.x());
  const auto first_y = static_cast<float>(first.y());
  const auto advance_x = static_cast<float>(advance.x());
  const auto advance_y = static_cast<float>(advance.y());
  const auto farthest = static_cast<float>(last);
  const Vignetting v = lens;
  for (std::size_t half = 0; half < 2; ++half) {
    const std::size_t begin = half * StretchLines::kHalf + line * kNear;
    const EachFloat steps = *eight(&kSteps[half * kNear]);
    const EachFloat at = steps < farthest ? steps : EachFloat{} + farthest;
    const EachFloat at_x = first_x + at * advance_x;
    const EachFloat at_y = first_y + at * advance_y;
    const EachFloat dx = at_x - v.middle_x;
    const EachFloat dy = at_y - v.middle_y;
    *eight(&lines.x[begin]) = at_x;
    *eight(&lines.y[begin]) = at_y;
    *eight(&lines.gain[begin]) = 1.0F - v.per_px2 * (dx * dx + dy * dy);
  }
}

LUMINAV_VECTOR_CLONES
void unveil(const StretchLines& lines, float* light) {
  for (std::size_t pair = 0; pair < lines.pairs; ++pair) {
    for (std::size_t half = 0; half < 2; ++half) {
      const std::size_t begin = half * StretchLines::kHalf + 2 * pair * kNear;
      const float* grey = &lines.grey[begin];
      const float* gain = &lines.gain[begin];
      float* a = light + 2 * pair * kRow + kFirst + half * kNear;
      float* b = a + kRow;
#pragma GCC ivdep
      for (std::size_t k = 0; k < kNear; ++k) {
        const bool saturated = std::max(grey[k], grey[kNear + k]) > kSaturated;
        a[k] = saturated ? -1.0F : grey[k] / gain[k];
        b[k] = saturated ? -1.0F : grey[kNear + k] / gain[kNear + k];
      }
    }
  }
}

LUMINAV_VECTOR_CLONES
void limit_near(float step, StretchLines& lines) {
  for (std::size_t pair = 0; pair < lines.pairs; ++pair) {
    const auto* gain = eight(&lines.gain[2 * pair * kNear]);
    auto* limit = eight(&lines.limit[2 * pair * kNear]);
    const EachFloat a = kSaturated / gain[0] - step;
    const EachFloat b = kSaturated / gain[1];
    const EachFloat low = a < b ? a : b;
    limit[0] = (low + step) * gain[0];
    limit[1] = low * gain[1];
  }
}

LUMINAV_VECTOR_CLONES
void unveil_cut(const StretchLines& lines, float* light, DistanceSums& room) {
  EachFloat rooms = *eight(room.data());
  for (std::size_t pair = 0; pair < lines.pairs; ++pair) {
    const std::size_t near = 2 * pair * kNear;
    const auto* grey = eight(&lines.grey[near]);
    const auto* limit = eight(&lines.limit[near]);
    rooms += 0.5F * (limit[0] - grey[0] + limit[1] - grey[1]);
    for (std::size_t half = 0; half < 2; ++half) {
      grey = eight(&lines.grey[half * StretchLines::kHalf + near]);
      const auto* gain = eight(&lines.gain[half * StretchLines::kHalf + near]);
      float* a = light + 2 * pair * kRow + kFirst + half * kNear;
      *eight(a) = grey[0] / gain[0];
      *eight(a + kRow) = grey[1] / gain[1];
    }
  }
  *eight(room.data()) = rooms;
}

std::optional<float> ceiling_step(const Stretches& stretches) {
  alignas(32) std::array<float, kNear> sums{};
  std::size_t count = 0;
  for (const StretchLines& lines : stretches) {
    count += add_far_differences(lines, sums.data());
  }
  if (count == 0) {
    return std::nullopt;
  }
  constexpr std::size_t kFar = kDistances - kNear;
  std::nth_element(sums.begin(), sums.begin() + kFar / 2, sums.begin() + kFar);
  return sums[kFar / 2] / static_cast<float>(count);
}

LUMINAV_VECTOR_CLONES
void compare(const float* light, std::size_t pairs, StretchSums& sums) {
  alignas(32) std::array<float, kPadded> by_two;  // [1/px] where the one before is valid, to the one after
  alignas(32) std::array<float, kPadded> by_one;
  by_two.fill(0.5F);
  by_one.fill(1.0F);
  by_two[0] = by_two[kDistances - 1] = 1.0F;
  by_one[kDistances - 1] = 0.0F;  // there is none after it, and none before: it says nothing
  for (std::size_t k = 0; k < kPadded; k += kLanes) {
    const EachFloat to_two = *eight(&by_two[k]);
    const EachFloat to_one = *eight(&by_one[k]);
    EachFloat difference{};
    std::array<EachFloat, 2> fall{};
    EachInt lines{};
    EachInt falls{};
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      const float* a = light + 2 * pair * kRow + kFirst + k;
      const float* b = a + kRow;
      const EachFloat here_a = *eight(a);
      const EachFloat here_b = *eight(b);
      const EachFloat before_a = *eight(a - 1);
      const EachFloat after_a = *eight(a + 1);
      const EachInt here = here_a >= 0.0F;
      const EachInt before = before_a >= 0.0F;
      const EachFloat per_px = before ? to_two : to_one;
      const EachInt falls_on = here & (after_a >= 0.0F) & (per_px > 0.0F);
      const EachFloat fall_a = ((before ? before_a : here_a) - after_a) * per_px;
      const EachFloat fall_b = ((before ? *eight(b - 1) : here_b) - *eight(b + 1)) * per_px;
      difference += here ? here_a - here_b : EachFloat{};
      lines -= here;
      fall[0] += falls_on ? fall_a : EachFloat{};
      fall[1] += falls_on ? fall_b : EachFloat{};
      falls -= falls_on;
    }
    std::memcpy(&sums.difference[k], &difference, sizeof difference);
    std::memcpy(&sums.lines[k], &lines, sizeof lines);
    std::memcpy(&sums.fall[0][k], &fall[0], sizeof fall[0]);
    std::memcpy(&sums.fall[1][k], &fall[1], sizeof fall[1]);
    std::memcpy(&sums.falls[k], &falls, sizeof falls);
  }
}

}  // namespace luminav
