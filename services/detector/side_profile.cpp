#include "services/detector/side_profile.hpp"

#include <algorithm>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMostSteps = SideProfile::kMostSteps;
static_assert(kMostSteps % 8 == 0);

constexpr std::array<double, kMostSteps> count_up() {
  std::array<double, kMostSteps> steps{};
  for (std::size_t k = 0; k < kMostSteps; ++k) {
    steps[k] = static_cast<double>(k);
  }
  return steps;
}

/// `count` places from `begin` on, those after the `last` like that one.
LUMINAV_VECTOR_CLONES
void place_across(const Vector2d& begin, const Vector2d& step, double last, std::size_t count, float* x, float* y) {
  static constexpr std::array<double, kMostSteps> kSteps = count_up();
  const double begin_x = begin.x();
  const double begin_y = begin.y();
  const double step_x = step.x();
  const double step_y = step.y();
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const double at = kSteps[k] < last ? kSteps[k] : last;
    x[k] = static_cast<float>(begin_x + at * step_x);
    y[k] = static_cast<float>(begin_y + at * step_y);
  }
}

LUMINAV_VECTOR_CLONES
void add_up(const float* grey, std::size_t count, double* sums) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    sums[k] += static_cast<double>(grey[k]);
  }
}

}  // namespace

SideProfile mean_profile(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                         const ProfileLines& lines) {
  SideProfile profile;
  profile.steps = std::min(kMostSteps, lines.steps);
  const PointTransform pose(side.pose);
  const double first = side.distance + lines.first;
  const double length = lines.step * static_cast<double>(profile.steps - 1);
  std::array<Vector2d, 2 * SideProfile::kMostLines> places;
  const auto count = static_cast<std::size_t>(std::min(SideProfile::kMostLines, lines.count));
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d place = (lines.from + lines.apart * static_cast<double>(i)) * side.along;
    places[2 * i] = pose * (place + first * side.out);
    places[2 * i + 1] = pose * (place + (first + length) * side.out);
  }
  std::array<Vector2d, 2 * SideProfile::kMostLines> pixels;
  camera.pixels_of_ceiling_points({places.data(), 2 * count}, side.height, {pixels.data(), 2 * count});
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d& begin = pixels[2 * i];
    const Vector2d& end = pixels[2 * i + 1];
    if (!is_sampled(image, begin) || !is_sampled(image, end)) {  // or there is no pixel
      continue;
    }
    const Vector2d step = (end - begin) / static_cast<double>(profile.steps - 1);
    alignas(32) std::array<float, kMostSteps> x;
    alignas(32) std::array<float, kMostSteps> y;
    alignas(32) std::array<float, kMostSteps> grey;
    const std::size_t padded = (profile.steps + 7) / 8 * 8;
    place_across(begin, step, static_cast<double>(profile.steps - 1), padded, x.data(), y.data());
    bilinear_at(image, x.data(), y.data(), padded, grey.data());
    add_up(grey.data(), profile.steps, profile.grey.data());
    ++profile.lines;
  }
  for (double& grey : profile.grey) {
    grey /= std::max(profile.lines, 1);
  }
  return profile;
}

}  // namespace luminav
