#include "services/detector/opposite_sides.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/pixel_sampling.hpp"
#include "services/detector/side_profile.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kStretches = Differences::kStretches;
constexpr std::size_t kDistances = Differences::kDistances;
constexpr std::size_t kMostLines = OppositeSides::kMostLines;
constexpr std::size_t kPadded = 16;  // the distances, filled up to whole vectors
constexpr float kSaturated = 250.0F;
constexpr double kCorner = 6.0;          // [px] from a corner nothing is compared
constexpr std::size_t kLeastInView = 5;  // distances: less of the fall of the light says too little
constexpr double kLinesApart = 1.0;      // [px] at least: nearer ones see the same pixels

constexpr std::size_t kRow = kPadded + 16;  // a line's lights with room for the neighbours of the first and last
constexpr std::size_t kFirst = 8;           // of them

/// Numbers that one instruction works on, where the processor can. The compiler does not find that in `compare`.
constexpr std::size_t kLanes = 8;
using EachFloat [[gnu::vector_size(kLanes * sizeof(float))]] = float;
using EightInMemory [[gnu::vector_size(kLanes * sizeof(float)), gnu::aligned(4), gnu::may_alias]] = float;
using EachInt [[gnu::vector_size(kLanes * sizeof(int))]] = int;

/// What the lens takes of the light towards the image's corners.
struct Vignetting {
  float per_px2;   // share that is lost, of the squared distance from the middle
  float middle_x;  // [px]
  float middle_y;
};

/// The lines of one stretch in pairs, from the positive and from the negative side.
struct StretchLines {
  static constexpr std::size_t kSamples = 2 * kMostLines * kPadded;
  alignas(32) std::array<float, kSamples> x;  // [px]
  alignas(32) std::array<float, kSamples> y;
  alignas(32) std::array<float, kSamples> gain;
  alignas(32) std::array<float, kSamples> grey;
  alignas(32) std::array<float, 2 * kMostLines * kRow> light{};
};

/// Over the lines of one stretch.
struct StretchSums {
  alignas(32) std::array<float, kPadded> difference{};
  alignas(32) std::array<int, kPadded> lines{};
  alignas(32) std::array<std::array<float, kPadded>, 2> fall{};
  alignas(32) std::array<int, kPadded> falls{};
};

constexpr std::array<float, kPadded> count_up() {
  std::array<float, kPadded> steps{};
  for (std::size_t k = 0; k < kPadded; ++k) {
    steps[k] = static_cast<float>(k);
  }
  return steps;
}

/// Those after the `last` like that one.
LUMINAV_VECTOR_CLONES
void place_along(const Vector2d& first, const Vector2d& advance, std::size_t last, const Vignetting& lens, float* x,
                 float* y, float* gain) {
  alignas(32) static constexpr std::array<float, kPadded> kSteps = count_up();
  const auto first_x = static_cast<float>(first.x());
  const auto first_y = static_cast<float>(first.y());
  const auto advance_x = static_cast<float>(advance.x());
  const auto advance_y = static_cast<float>(advance.y());
  const auto farthest = static_cast<float>(last);
  const Vignetting v = lens;
#pragma GCC ivdep
  for (std::size_t k = 0; k < kPadded; ++k) {
    const float at = kSteps[k] < farthest ? kSteps[k] : farthest;
    const float at_x = first_x + at * advance_x;
    const float at_y = first_y + at * advance_y;
    const float dx = at_x - v.middle_x;
    const float dy = at_y - v.middle_y;
    x[k] = at_x;
    y[k] = at_y;
    gain[k] = 1.0F - v.per_px2 * (dx * dx + dy * dy);
  }
}

/// How many distances from the first on are in view, all of them up to there.
std::size_t count_in_view(const GreyView& image, const Vector2d& first, const Vector2d& advance) {
  if (!is_sampled(image, first)) {  // or there is no pixel
    return 0;
  }
  std::size_t count = kDistances;
  while (count > 1 && !is_sampled(image, first + static_cast<double>(count - 1) * advance)) {
    --count;
  }
  return count;
}

/// Undoes vignetting; negative where one of a pair is saturated.
LUMINAV_VECTOR_CLONES
void unveil(const float* grey, const float* gain, std::size_t pairs, float* light) {
  for (std::size_t pair = 0; pair < pairs; ++pair, grey += 2 * kPadded, gain += 2 * kPadded, light += 2 * kRow) {
    float* a = light + kFirst;
    float* b = a + kRow;
#pragma GCC ivdep
    for (std::size_t k = 0; k < kPadded; ++k) {
      const bool saturated = std::max(grey[k], grey[kPadded + k]) > kSaturated;
      a[k] = saturated ? -1.0F : grey[k] / gain[k];
      b[k] = saturated ? -1.0F : grey[kPadded + k] / gain[kPadded + k];
    }
    a[-1] = a[0];
    b[-1] = b[0];
  }
}

/// Adds what opposite lines differ by and how the light falls along each, between the neighbours that are valid. The
/// first of a line is its own neighbour, and so is the last: the samples beyond it are the same.
LUMINAV_VECTOR_CLONES
void compare(const float* light, std::size_t pairs, StretchSums& sums) {
  alignas(32) std::array<float, kPadded> by_two;  // [1/px] where the one before is valid, to the one after
  alignas(32) std::array<float, kPadded> by_one;
  const auto eight = [](const float* values) { return reinterpret_cast<const EightInMemory*>(values); };
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

}  // namespace

Differences OppositeSides::measure(const Pose2& robot_from_outline, double step) const {
  Differences result;
  result.apart = 2.0 * half_width_ / step;
  const double usable = length_ - 2.0 * std::min(kCorner * step, 0.2 * length_);
  const double stretch_px = usable / (step * static_cast<double>(kStretches));
  const std::size_t count = std::clamp<std::size_t>(static_cast<std::size_t>(stretch_px / kLinesApart), 2, kMostLines);
  std::array<LineEnds, 2 * kStretches * kMostLines> lines;
  project(PointTransform(robot_from_outline), usable, step, count, lines);
  const double width = image_.width;
  const double height = image_.height;
  const Vignetting lens{static_cast<float>(vignetting_ / (0.25 * (width * width + height * height))),
                        static_cast<float>(0.5 * width), static_cast<float>(0.5 * height)};
  std::array<std::array<double, kDistances>, 2> falls{};  // sums over all lines
  std::array<int, kDistances> fall_counts{};
  StretchLines seen;
  for (std::size_t stretch = 0; stretch < kStretches; ++stretch) {
    result.place[stretch] = usable * ((static_cast<double>(stretch) + 0.5) / kStretches - 0.5);
    StretchSums sums;
    std::size_t pairs = 0;
    std::array<std::size_t, kMostLines> in_view;
    for (std::size_t line = stretch * count; line < (stretch + 1) * count; ++line) {
      const std::size_t both = std::min(lines[2 * line].in_view, lines[2 * line + 1].in_view);
      if (both < kLeastInView) {
        continue;
      }
      in_view[pairs] = both;
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
        const LineEnds& ends = lines[2 * line + side];
        const std::size_t first = (2 * pairs + side) * kPadded;
        place_along(ends.first, ends.advance, both - 1, lens, &seen.x[first], &seen.y[first], &seen.gain[first]);
      }
      ++pairs;
    }
    bilinear_at(image_, seen.x.data(), seen.y.data(), 2 * pairs * kPadded, seen.grey.data());
    unveil(seen.grey.data(), seen.gain.data(), pairs, seen.light.data());
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      for (std::size_t k = in_view[pair]; k < kDistances; ++k) {
        seen.light[2 * pair * kRow + kFirst + k] = seen.light[(2 * pair + 1) * kRow + kFirst + k] = -1.0F;
      }
    }
    compare(seen.light.data(), pairs, sums);
    for (std::size_t k = 0; k < kDistances; ++k) {
      falls[0][k] += static_cast<double>(sums.fall[0][k]);
      falls[1][k] += static_cast<double>(sums.fall[1][k]);
      fall_counts[k] += sums.falls[k];
      result.valid[stretch][k] = 2 * sums.lines[k] > static_cast<int>(count);
      if (result.valid[stretch][k]) {
        result.value[stretch][k] = sums.difference[k] / static_cast<float>(sums.lines[k]);
        ++result.count;
      }
    }
  }
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.fall[side][k] = fall_counts[k] > 0 ? falls[side][k] / fall_counts[k] : 0.0;
    }
  }
  return result;
}

bool OppositeSides::take_ceiling_off(const Pose2& robot_from_outline, double step, double from_corner,
                                     Differences& differences) const {
  constexpr int kBeyond = 16;       // lines beyond a corner
  constexpr double kApart = 0.012;  // [m] between them
  const SideLine positive{robot_from_outline, height_, along_, out_, 0.5 * length_, half_width_};
  const SideLine negative{robot_from_outline, height_, along_, -out_, 0.5 * length_, half_width_};
  std::array<std::array<double, kDistances>, 2> ceiling{};
  int corners = 0;
  for (const double corner : {1.0, -1.0}) {
    const ProfileLines lines{.first = -Differences::kInside * step,
                             .steps = kDistances,
                             .from = corner * (0.5 * length_ + from_corner),
                             .apart = corner * kApart,
                             .count = kBeyond,
                             .step = step};
    const std::array<SideProfile, 2> beyond{mean_profile(image_, camera_, positive, lines),
                                            mean_profile(image_, camera_, negative, lines)};
    if (std::min(beyond[0].lines, beyond[1].lines) < kBeyond / 2) {
      continue;
    }
    ++corners;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      for (std::size_t k = 0; k < kDistances; ++k) {
        ceiling[side][k] += beyond[side].grey[k];
      }
    }
  }
  for (std::size_t k = 0; corners > 0 && k < kDistances; ++k) {
    const auto difference = static_cast<float>((ceiling[0][k] - ceiling[1][k]) / corners);
    for (auto& stretch : differences.value) {
      stretch[k] -= difference;
    }
    const std::size_t before = k == 0 ? 0 : k - 1;
    const std::size_t after = std::min<std::size_t>(k + 1, kDistances - 1);
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      if (differences.fall[side][k] != 0.0) {  // or nothing is known of it
        differences.fall[side][k] -=
            (ceiling[side][before] - ceiling[side][after]) / (corners * static_cast<double>(after - before));
      }
    }
  }
  return corners > 0;
}

void OppositeSides::project(const PointTransform& pose, double usable, double step, std::size_t count,
                            std::span<LineEnds> lines) const {
  constexpr double kAhead = 0.02;  // [m]
  const std::size_t pairs = kStretches * count;
  std::array<Vector2d, 4 * kStretches * kMostLines> points;
  for (std::size_t line = 0; line < pairs; ++line) {
    const double place = usable * ((static_cast<double>(line) + 0.5) / static_cast<double>(pairs) - 0.5);
    for (const std::size_t negative : {std::size_t{0}, std::size_t{1}}) {
      const double side = negative == 0 ? 1.0 : -1.0;
      const Vector2d on_edge = place * along_ + side * half_width_ * out_;
      const std::size_t i = 4 * line + 2 * negative;
      points[i] = pose * on_edge;
      points[i + 1] = pose * (on_edge + kAhead * side * out_);
    }
  }
  std::array<Vector2d, 4 * kStretches * kMostLines> pixels;
  camera_.pixels_of_ceiling_points({points.data(), 4 * pairs}, height_, {pixels.data(), 4 * pairs});
  for (std::size_t i = 0; i < 2 * pairs; ++i) {
    const Vector2d& pixel = pixels[2 * i];
    LineEnds& line = lines[i];
    line.advance = (pixels[2 * i + 1] - pixel) * (step / kAhead);
    line.first = pixel - Differences::kInside * line.advance;
    line.in_view = count_in_view(image_, line.first, line.advance);
  }
}

}  // namespace luminav
