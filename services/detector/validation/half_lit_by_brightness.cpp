#include "services/detector/validation/half_lit_by_brightness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "services/detector/sampling/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr int kDistances = 40;          // from the strip's edge to 1.7 of its width beyond
constexpr int kPlaces = 21;             // along the strip
constexpr double kReach = 1.7;          // widths of the strip
constexpr double kFirst = 0.15;         // widths: nearer, bloom decides
constexpr double kClearlyDarker = 6.0;  // [grey]

double distance_of(int i) {
  return kFirst + (kReach - kFirst) * (i + 0.5) / kDistances;
}

double median(std::array<double, kDistances>& values, std::size_t count) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count / 2),
                   values.begin() + static_cast<std::ptrdiff_t>(count));
  return values[count / 2];
}

/// Median brightness along the strip, `widths` of it beyond its edge; nothing with too little in view.
std::optional<double> level_beside(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                                   const OutlinePlacement& placement, int side, double widths) {
  const PointTransform pose(placement.pose);
  std::array<float, kPlaces> values;
  std::size_t count = 0;
  std::array<Vector2d, kPlaces> places;
  for (int i = 0; i < kPlaces; ++i) {
    places[static_cast<std::size_t>(i)] =
        pose * Vector2d(0.9 * strip.length * ((i + 0.5) / kPlaces - 0.5),
                        side * ((0.5 + widths) * strip.width + std::max(0.0, placement.side_outset)));
  }
  std::array<Vector2d, kPlaces> pixels;
  camera.pixels_of_ceiling_points(places, strip.height, pixels);
  for (const Vector2d& pixel : pixels) {
    if (is_sampled(image, pixel)) {
      values[count++] = bilinear(image, static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
  }
  if (count < 6) {
    return std::nullopt;
  }
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count / 2),
                   values.begin() + static_cast<std::ptrdiff_t>(count));
  return values[count / 2];
}

/// Largest step between the stretches just inside and just outside of the place where a second strip would end.
double step_at_far_edge(const std::array<double, kDistances>& level) {
  double largest = 0.0;
  for (int i = 3; i + 3 < kDistances; ++i) {
    if (std::abs(distance_of(i) - 1.0) > 0.12) {
      continue;
    }
    const auto k = static_cast<std::size_t>(i);
    const double step = 0.5 * (level[k + 1] + level[k + 2]) - 0.5 * (level[k - 1] + level[k - 2]);
    largest = std::max(largest, std::abs(step));
  }
  return largest;
}

/// Mean over some distances, in units [m]; nothing where one of them is out of view.
std::optional<double> mean_beside(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                                  const OutlinePlacement& placement, int side, double unit,
                                  std::span<const double> distances) {
  double sum = 0.0;
  for (const double distance : distances) {
    const auto level = level_beside(image, camera, strip, placement, side, distance * unit / strip.width);
    if (!level) {
      return std::nullopt;
    }
    sum += *level;
  }
  return sum / static_cast<double>(distances.size());
}

}  // namespace

int find_darker_side(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                     const OutlinePlacement& placement, double dark_width, double pixel_noise) {
  constexpr std::array kNear{0.45, 0.6, 0.75};  // of the dark width
  constexpr std::array kFar{1.2, 1.35, 1.5};
  int found = 0;
  for (const int side : {1, -1}) {
    const auto near = mean_beside(image, camera, strip, placement, side, dark_width, kNear);
    const auto far = mean_beside(image, camera, strip, placement, side, dark_width, kFar);
    if (near && far && *near < *far - std::max({kClearlyDarker, 0.1 * *far, pixel_noise})) {
      found += side;
    }
  }
  return found;
}

StripSurroundings compare_strip_sides(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                                      const OutlinePlacement& placement, double pixel_noise) {
  StripSurroundings result;
  std::array<double, kDistances> left{};
  std::array<double, kDistances> right{};
  std::array<double, kDistances> difference{};
  std::array<double, kDistances> slopes{};
  std::array<double, kDistances> at{};
  std::size_t count = 0;
  double mean = 0.0;
  for (int i = 0; i < kDistances; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto a = level_beside(image, camera, strip, placement, 1, distance_of(i));
    const auto b = level_beside(image, camera, strip, placement, -1, distance_of(i));
    if (!a || !b) {
      break;
    }
    left[k] = *a;
    right[k] = *b;
    at[count] = distance_of(i) + 0.5;  // from the middle line, where both sides meet
    difference[count] = *a - *b;
    mean += 0.5 * (*a + *b);
    ++count;
  }
  if (count < kDistances / 2) {
    return result;
  }
  result.valid = true;
  mean /= static_cast<double>(count);
  const bool complete = count == kDistances;  // to beyond where a second strip would end
  // The slope of the light, from beyond a second strip where that is in view.
  constexpr double kBeyond = 1.15 + 0.5;
  std::size_t far = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (!complete || at[k] > kBeyond) {
      slopes[far++] = difference[k] / at[k];
    }
  }
  const double slope = median(slopes, far);
  // the median of 21 has 1.25 / sqrt(21) = 0.27 of the noise of one
  const double tolerance = std::max({4.0, 0.04 * mean, 3.0 * 0.27 * 1.41 * pixel_noise});
  std::size_t different = 0;
  for (std::size_t k = 0; k < count; ++k) {
    different += std::abs(difference[k] - slope * at[k]) > tolerance ? 1U : 0U;
  }
  result.asymmetry = static_cast<double>(different) / static_cast<double>(count);
  if (complete) {
    const double on_left = step_at_far_edge(left);
    const double on_right = step_at_far_edge(right);
    if (std::max(on_left, on_right) > 1.3 * std::min(on_left, on_right) + 0.5 * tolerance) {
      result.side = on_left > on_right ? 1 : -1;
    }
  }
  return result;
}

}  // namespace luminav
