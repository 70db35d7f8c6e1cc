#include "services/detector/opposite_sides.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "services/detector/opposite_lines.hpp"
#include "services/detector/pixel_sampling.hpp"
#include "services/detector/side_profile.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kStretches = Differences::kStretches;
constexpr std::size_t kDistances = Differences::kDistances;
constexpr std::size_t kMostLines = OppositeSides::kMostLines;
constexpr double kCorner = 6.0;          // [px] from a corner nothing is compared
constexpr std::size_t kLeastInView = 5;  // distances: less of the fall of the light says too little
constexpr double kLinesApart = 1.0;      // [px] at least: nearer ones see the same pixels
constexpr double kLeastRoom = 2.0;       // [grey] below the limit on average: with less nothing is left to compare

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

/// Over the lines of all stretches, by distance.
struct StretchTotals {
  std::array<std::array<double, kDistances>, 2> falls{};
  std::array<int, kDistances> fall_counts{};
  DistanceSums room{};
  std::size_t pairs = 0;

  void add(const StretchSums& sums) {
    for (std::size_t k = 0; k < kDistances; ++k) {
      falls[0][k] += static_cast<double>(sums.fall[0][k]);
      falls[1][k] += static_cast<double>(sums.fall[1][k]);
      fall_counts[k] += sums.falls[k];
    }
  }
  [[nodiscard]] double fall(std::size_t side, std::size_t k) const {
    return fall_counts[k] > 0 ? falls[side][k] / fall_counts[k] : 0.0;
  }
  /// Where both sides are at their limits there is nothing to compare.
  [[nodiscard]] bool is_cut_off(std::size_t k) const {
    return k < kNear && static_cast<double>(room[k]) < kLeastRoom * static_cast<double>(pairs);
  }
};

/// Compares the lines of a stretch, of which the far halves have been sampled: cut off where the positive side's
/// ceiling is known to be `brighter` [grey], otherwise without what is saturated.
StretchSums compare_near(const GreyView& image, const std::optional<float>& brighter, StretchLines& lines,
                         StretchTotals& totals) {
  alignas(32) std::array<float, 2 * kMostLines * kRow> light{};
  if (brighter) {
    limit_near(*brighter, lines);
    bilinear_below_at(image, lines.x.data(), lines.y.data(), lines.limit.data(), 2 * lines.pairs * kNear,
                      lines.grey.data());
    unveil_cut(lines, light.data(), totals.room);
  } else {
    bilinear_at(image, lines.x.data(), lines.y.data(), 2 * lines.pairs * kNear, lines.grey.data());
    unveil(lines, light.data());
  }
  totals.pairs += lines.pairs;
  for (std::size_t line = 0; line < 2 * lines.pairs; ++line) {
    float* of_line = &light[line * kRow + kFirst];
    of_line[-1] = of_line[0];
    std::fill(of_line + lines.in_view[line / 2], of_line + kDistances, -1.0F);
  }
  StretchSums sums;
  compare(light.data(), lines.pairs, sums);
  totals.add(sums);
  return sums;
}

}  // namespace

Differences OppositeSides::measure(const Pose2& robot_from_outline, double step, Saturated saturated) const {
  Differences result;
  result.apart = 2.0 * half_width_ / step;
  const double usable = length_ - 2.0 * std::min(kCorner * step, 0.2 * length_);
  const double stretch_px = usable / (step * static_cast<double>(kStretches));
  const std::size_t count = std::clamp<std::size_t>(static_cast<std::size_t>(stretch_px / kLinesApart), 2, kMostLines);
  result.lines = static_cast<int>(count);
  std::array<LineEnds, 2 * kStretches * kMostLines> lines;
  project(PointTransform(robot_from_outline), usable, step, count, lines);
  Stretches stretches;
  place_lines(lines, count, stretches);
  constexpr std::size_t kHalf = StretchLines::kHalf;
  for (StretchLines& seen : stretches) {
    bilinear_at(image_, &seen.x[kHalf], &seen.y[kHalf], 2 * seen.pairs * kNear, &seen.grey[kHalf]);
  }
  // Without it there is nothing to tell how high above their ceilings the sides are cut off.
  const std::optional<float> brighter = saturated == Saturated::kCutOff ? ceiling_step(stretches) : std::nullopt;
  StretchTotals totals;
  for (std::size_t stretch = 0; stretch < kStretches; ++stretch) {
    result.place[stretch] = usable * ((static_cast<double>(stretch) + 0.5) / kStretches - 0.5);
    const StretchSums sums = compare_near(image_, brighter, stretches[stretch], totals);
    for (std::size_t k = 0; k < kDistances; ++k) {
      result.valid[stretch][k] = 2 * sums.lines[k] > static_cast<int>(count);
      if (result.valid[stretch][k]) {
        result.value[stretch][k] = sums.difference[k] / static_cast<float>(sums.lines[k]);
      }
    }
  }
  for (std::size_t k = 0; k < kDistances; ++k) {
    const bool is_cut_off = brighter && totals.is_cut_off(k);
    for (std::size_t stretch = 0; stretch < kStretches; ++stretch) {
      result.valid[stretch][k] = result.valid[stretch][k] && !is_cut_off;
      result.count += result.valid[stretch][k] ? 1 : 0;
    }
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      result.fall[side][k] = totals.fall(side, k);
    }
  }
  return result;
}

void OppositeSides::place_lines(std::span<const LineEnds> lines, std::size_t count, Stretches& stretches) const {
  const double width = image_.width;
  const double height = image_.height;
  const Vignetting lens{static_cast<float>(vignetting_ / (0.25 * (width * width + height * height))),
                        static_cast<float>(0.5 * width), static_cast<float>(0.5 * height)};
  for (std::size_t line = 0; line < kStretches * count; ++line) {
    StretchLines& stretch = stretches[line / count];
    const LineEnds& positive = lines[2 * line];
    const LineEnds& negative = lines[2 * line + 1];
    const std::size_t both = std::min(positive.in_view, negative.in_view);
    if (both < kLeastInView) {
      continue;
    }
    stretch.in_view[stretch.pairs] = both;
    place_along(positive.first, positive.advance, both - 1, lens, 2 * stretch.pairs, stretch);
    place_along(negative.first, negative.advance, both - 1, lens, 2 * stretch.pairs + 1, stretch);
    ++stretch.pairs;
  }
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
  // Within a stretch the lens bends a side by less than a hundredth of a pixel: only where stretches meet are lines
  // projected, and those between are taken from these.
  constexpr std::size_t kMeetings = kStretches + 1;
  std::array<Vector2d, 4 * kMeetings> points;
  for (std::size_t meeting = 0; meeting < kMeetings; ++meeting) {
    const double place = usable * (static_cast<double>(meeting) / static_cast<double>(kStretches) - 0.5);
    for (const std::size_t negative : {std::size_t{0}, std::size_t{1}}) {
      const double side = negative == 0 ? 1.0 : -1.0;
      const Vector2d on_edge = place * along_ + side * half_width_ * out_;
      const std::size_t i = 4 * meeting + 2 * negative;
      points[i] = pose * on_edge;
      points[i + 1] = pose * (on_edge + kAhead * side * out_);
    }
  }
  std::array<Vector2d, 4 * kMeetings> pixels;
  camera_.pixels_of_ceiling_points(points, height_, pixels);
  for (std::size_t stretch = 0; stretch < kStretches; ++stretch) {
    for (const std::size_t negative : {std::size_t{0}, std::size_t{1}}) {
      const Vector2d* from = &pixels[4 * stretch + 2 * negative];
      const Vector2d* to = from + 4;
      for (std::size_t i = 0; i < count; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        const Vector2d pixel = from[0] + share * (to[0] - from[0]);
        const Vector2d ahead = from[1] + share * (to[1] - from[1]);
        LineEnds& line = lines[2 * (stretch * count + i) + negative];
        line.advance = (ahead - pixel) * (step / kAhead);
        line.first = pixel - Differences::kInside * line.advance;
        line.in_view = count_in_view(image_, line.first, line.advance);
      }
    }
  }
}

}  // namespace luminav
