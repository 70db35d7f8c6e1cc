#include "services/detector/opposite_sides.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/pixel_sampling.hpp"
#include "services/detector/side_profile.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kStretches = Differences::kStretches;
constexpr int kDistances = Differences::kDistances;
constexpr int kLinesPerStretch = 6;  // profiles in a stretch
constexpr int kLines = kStretches * kLinesPerStretch;
constexpr int kPadded = 16;  // the distances, filled up to whole vectors
constexpr float kSaturated = 250.0F;
constexpr double kCorner = 6.0;  // [px] from a corner nothing is compared
constexpr int kLeastInView = 5;  // distances: less of the fall of the light says too little

constexpr std::size_t kRow = kPadded + 16;  // a line's lights with room for the neighbours of the first and last
constexpr std::size_t kFirst = 8;           // of them

/// What the lens takes of the light towards the image's corners.
struct Vignetting {
  double share;
  double middle_x;  // [px]
  double middle_y;
  double corner;  // [px^2] squared distance from the middle
};

/// The lines of one stretch in pairs, from the positive and from the negative side.
struct StretchLines {
  static constexpr std::size_t kSamples = std::size_t{2} * kLinesPerStretch * kPadded;
  alignas(32) std::array<float, kSamples> x;  // [px]
  alignas(32) std::array<float, kSamples> y;
  alignas(32) std::array<float, kSamples> gain;
  alignas(32) std::array<float, kSamples> grey;
  alignas(32) std::array<float, 2 * kLinesPerStretch * kRow> light{};
};

/// Over the lines of one stretch.
struct DifferenceSums {
  alignas(32) std::array<float, kPadded> difference{};
  alignas(32) std::array<int, kPadded> lines{};
};

/// Over all lines.
struct Falls {
  alignas(32) std::array<std::array<double, kPadded>, 2> sum{};
  alignas(32) std::array<int, kPadded> count{};
};

constexpr std::array<double, kPadded> count_up() {
  std::array<double, kPadded> steps{};
  for (int k = 0; k < kPadded; ++k) {
    steps[static_cast<std::size_t>(k)] = k;
  }
  return steps;
}

/// Those after the `last` like that one.
LUMINAV_VECTOR_CLONES
void place_along(const Vector2d& first, const Vector2d& advance, double last, const Vignetting& lens, float* x,
                 float* y, float* gain) {
  static constexpr std::array<double, kPadded> kSteps = count_up();
  const double first_x = first.x();
  const double first_y = first.y();
  const double advance_x = advance.x();
  const double advance_y = advance.y();
  const Vignetting v = lens;
#pragma GCC ivdep
  for (std::size_t k = 0; k < kPadded; ++k) {
    const double at = kSteps[k] < last ? kSteps[k] : last;
    const double at_x = first_x + at * advance_x;
    const double at_y = first_y + at * advance_y;
    const double dx = at_x - v.middle_x;
    const double dy = at_y - v.middle_y;
    x[k] = static_cast<float>(at_x);
    y[k] = static_cast<float>(at_y);
    gain[k] = static_cast<float>(1.0 - v.share * (dx * dx + dy * dy) / v.corner);
  }
}

/// How many distances from the first on are in view, all of them up to there.
int count_in_view(const GreyView& image, const Vector2d& first, const Vector2d& advance) {
  if (!is_sampled(image, first)) {  // or there is no pixel
    return 0;
  }
  int count = kDistances;
  while (count > 1 && !is_sampled(image, first + (count - 1) * advance)) {
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
void compare(const float* light, std::size_t pairs, DifferenceSums& sums, Falls& falls) {
  alignas(32) std::array<float, kPadded> by_two;  // [1/px] where the one before is valid, to the one after
  alignas(32) std::array<float, kPadded> by_one;
  by_two.fill(0.5F);
  by_one.fill(1.0F);
  by_two[0] = by_two[kDistances - 1] = 1.0F;
  by_one[kDistances - 1] = 0.0F;  // there is none after it, and none before: it says nothing
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    const float* a = light + 2 * pair * kRow + kFirst;
    const float* b = a + kRow;
    alignas(32) std::array<std::array<float, kPadded>, 2> fall;
    for (std::ptrdiff_t k = 0; k < kPadded; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const bool before = a[k - 1] >= 0.0F;
      const bool here = a[k] >= 0.0F;
      const float per_px = before ? by_two[i] : by_one[i];
      const bool falls_on = here & (a[k + 1] >= 0.0F) & (per_px > 0.0F);
      const float fall_a = ((before ? a[k - 1] : a[k]) - a[k + 1]) * per_px;
      const float fall_b = ((before ? b[k - 1] : b[k]) - b[k + 1]) * per_px;
      sums.difference[i] += here ? a[k] - b[k] : 0.0F;
      sums.lines[i] += here ? 1 : 0;
      falls.count[i] += falls_on ? 1 : 0;
      fall[0][i] = falls_on ? fall_a : 0.0F;
      fall[1][i] = falls_on ? fall_b : 0.0F;
    }
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t k = 0; k < kPadded; ++k) {
        falls.sum[side][k] += static_cast<double>(fall[side][k]);
      }
    }
  }
}

}  // namespace

Differences OppositeSides::measure(const Pose2& robot_from_outline, double step) const {
  Differences result;
  result.apart = 2.0 * half_width_ / step;
  const double usable = length_ - 2.0 * std::min(kCorner * step, 0.2 * length_);
  std::array<LineEnds, 2 * kLines> lines;
  project(PointTransform(robot_from_outline), usable, step, lines);
  const double width = image_.width;
  const double height = image_.height;
  const Vignetting lens{vignetting_, 0.5 * width, 0.5 * height, 0.25 * (width * width + height * height)};
  Falls falls;
  StretchLines seen;
  for (int s = 0; s < kStretches; ++s) {
    const auto stretch = static_cast<std::size_t>(s);
    result.place[stretch] = usable * ((s + 0.5) / kStretches - 0.5);
    DifferenceSums sums;
    std::size_t pairs = 0;
    std::array<int, kLinesPerStretch> in_view;
    for (std::size_t line = stretch * kLinesPerStretch; line < (stretch + 1) * kLinesPerStretch; ++line) {
      const int both = std::min(lines[2 * line].in_view, lines[2 * line + 1].in_view);
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
      for (std::size_t k = static_cast<std::size_t>(in_view[pair]); k < kDistances; ++k) {
        seen.light[2 * pair * kRow + kFirst + k] = seen.light[(2 * pair + 1) * kRow + kFirst + k] = -1.0F;
      }
    }
    compare(seen.light.data(), pairs, sums, falls);
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.valid[stretch][k] = 2 * sums.lines[k] > kLinesPerStretch;
      if (result.valid[stretch][k]) {
        result.value[stretch][k] = sums.difference[k] / static_cast<float>(sums.lines[k]);
        ++result.count;
      }
    }
  }
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.fall[side][k] = falls.count[k] > 0 ? falls.sum[side][k] / falls.count[k] : 0.0;
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

void OppositeSides::project(const PointTransform& pose, double usable, double step, std::span<LineEnds> lines) const {
  constexpr double kAhead = 0.02;  // [m]
  std::array<Vector2d, 4 * kLines> points;
  for (int line = 0; line < kLines; ++line) {
    const double place = usable * ((line + 0.5) / kLines - 0.5);
    for (const int negative : {0, 1}) {
      const double side = negative == 0 ? 1.0 : -1.0;
      const Vector2d on_edge = place * along_ + side * half_width_ * out_;
      const auto i = static_cast<std::size_t>(4 * line + 2 * negative);
      points[i] = pose * on_edge;
      points[i + 1] = pose * (on_edge + kAhead * side * out_);
    }
  }
  std::array<Vector2d, 4 * kLines> pixels;
  camera_.pixels_of_ceiling_points(points, height_, pixels);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Vector2d& pixel = pixels[2 * i];
    LineEnds& line = lines[i];
    line.advance = (pixels[2 * i + 1] - pixel) * (step / kAhead);
    line.first = pixel - Differences::kInside * line.advance;
    line.in_view = count_in_view(image_, line.first, line.advance);
  }
}

}  // namespace luminav
