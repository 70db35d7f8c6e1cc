#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "services/detector/opposite_sides.hpp"

namespace luminav {

// Lines outwards from opposite sides of a lit outline, `Differences::kDistances` samples each, filled up to whole
// vectors.
inline constexpr std::size_t kPadded = 16;
inline constexpr std::size_t kNear = 8;  // half of those: bloom within and mere ceiling beyond
// Lights of a line with room for the neighbours of the first and last, and the first of them:
inline constexpr std::size_t kRow = kPadded + 16;
inline constexpr std::size_t kFirst = 8;

/// What the lens takes of the light towards the image's corners.
struct Vignetting {
  float per_px2;   // share that is lost, of the squared distance from the middle
  float middle_x;  // [px]
  float middle_y;
};

/// The lines of one stretch in pairs, from the positive and from the negative side; the near halves of all lines, then
/// the far halves.
struct StretchLines {
  static constexpr std::size_t kHalf = 2 * OppositeSides::kMostLines * kNear;
  alignas(32) std::array<float, 2 * kHalf> x;  // [px]
  alignas(32) std::array<float, 2 * kHalf> y;
  alignas(32) std::array<float, 2 * kHalf> gain;
  alignas(32) std::array<float, 2 * kHalf> grey;
  alignas(32) std::array<float, kHalf> limit;                  // [grey] of pixels
  std::array<std::size_t, OppositeSides::kMostLines> in_view;  // distances, of each pair
  std::size_t pairs = 0;
};
using Stretches = std::array<StretchLines, Differences::kStretches>;

/// By distance, over all lines.
using DistanceSums = std::array<float, kPadded>;

/// Over the lines of one stretch.
struct StretchSums {
  alignas(32) std::array<float, kPadded> difference{};
  alignas(32) std::array<int, kPadded> lines{};
  alignas(32) std::array<std::array<float, kPadded>, 2> fall{};
  alignas(32) std::array<int, kPadded> falls{};
};

/// Places the samples of a line and says what the lens lets through there. Those after the `last` like that one.
void place_along(const Eigen::Vector2d& first, const Eigen::Vector2d& advance, std::size_t last, const Vignetting& lens,
                 std::size_t line, StretchLines& lines);

/// By how much the ceiling is brighter on the positive side [grey], from the far halves' grey levels: the median over
/// their distances. Nothing where they are out of view.
std::optional<float> ceiling_step(const Stretches& stretches);

/// The near pixels' grey levels at which both sides are cut off equally high above their ceilings, where the positive
/// side's ceiling is brighter by `step` [grey].
void limit_near(float step, StretchLines& lines);

/// Lights of opposite lines, `kRow` apart, with vignetting undone; negative where one of a pair is saturated.
void unveil(const StretchLines& lines, float* light);

/// As `unveil`, but of pixels that were cut off; adds up how far [grey] the near ones stay below their limits.
void unveil_cut(const StretchLines& lines, float* light, DistanceSums& room);

/// Adds what opposite lines differ by and how the light falls along each, between the neighbours that are valid. The
/// first of a line is its own neighbour, and so is the last: the samples beyond it are the same.
void compare(const float* light, std::size_t pairs, StretchSums& sums);

}  // namespace luminav
