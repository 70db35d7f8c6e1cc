#include "services/detector/side_profile.hpp"

#include <algorithm>
#include <span>

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

struct Line {
  Vector2d begin;  // [px]
  Vector2d step;   // [px]
};
constexpr std::size_t kAtOnce = 8;  // lines

/// `count` places along each line, those after the `last` like that one.
LUMINAV_VECTOR_CLONES
void place_along(std::span<const Line> lines, double last, std::size_t count, float* x, float* y) {
  static constexpr std::array<double, kMostSteps> kSteps = count_up();
  for (const Line& line : lines) {
    const double begin_x = line.begin.x();
    const double begin_y = line.begin.y();
    const double step_x = line.step.x();
    const double step_y = line.step.y();
#pragma GCC ivdep
    for (std::size_t k = 0; k < count; ++k) {
      const double at = kSteps[k] < last ? kSteps[k] : last;
      x[k] = static_cast<float>(begin_x + at * step_x);
      y[k] = static_cast<float>(begin_y + at * step_y);
    }
    x += count;
    y += count;
  }
}

/// The first `steps` of each line.
LUMINAV_VECTOR_CLONES
void add_up(const float* grey, std::size_t lines, std::size_t apart, std::size_t steps, double* sums) {
  for (std::size_t line = 0; line < lines; ++line, grey += apart) {
#pragma GCC ivdep
    for (std::size_t k = 0; k < steps; ++k) {
      sums[k] += static_cast<double>(grey[k]);
    }
  }
}

}  // namespace

SideProfile mean_profile(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                         const ProfileLines& lines) {
  SideProfile profile;
  profile.steps = std::min(kMostSteps, lines.steps);
  const PointTransform pose(side.pose);
  const double nearest = side.distance + lines.first;
  const double length = lines.step * static_cast<double>(profile.steps - 1);
  std::array<Vector2d, 2 * SideProfile::kMostLines> places;
  const auto count = static_cast<std::size_t>(std::min(SideProfile::kMostLines, lines.count));
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d place = (lines.from + lines.apart * static_cast<double>(i)) * side.along;
    places[2 * i] = pose * (place + nearest * side.out);
    places[2 * i + 1] = pose * (place + (nearest + length) * side.out);
  }
  std::array<Vector2d, 2 * SideProfile::kMostLines> pixels;
  camera.pixels_of_ceiling_points({places.data(), 2 * count}, side.height, {pixels.data(), 2 * count});
  std::array<Line, SideProfile::kMostLines> seen;
  std::size_t seen_count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2d& begin = pixels[2 * i];
    const Vector2d& end = pixels[2 * i + 1];
    if (is_sampled(image, begin) && is_sampled(image, end)) {  // false where there is no pixel
      seen[seen_count++] = {begin, (end - begin) / static_cast<double>(profile.steps - 1)};
    }
  }
  const std::size_t padded = (profile.steps + 7) / 8 * 8;
  alignas(32) std::array<float, kAtOnce * kMostSteps> x;
  alignas(32) std::array<float, kAtOnce * kMostSteps> y;
  alignas(32) std::array<float, kAtOnce * kMostSteps> grey;
  for (std::size_t first = 0; first < seen_count; first += kAtOnce) {
    const std::span<const Line> some = std::span(seen).subspan(first, std::min(kAtOnce, seen_count - first));
    place_along(some, static_cast<double>(profile.steps - 1), padded, x.data(), y.data());
    bilinear_at(image, x.data(), y.data(), some.size() * padded, grey.data());
    add_up(grey.data(), some.size(), padded, profile.steps, profile.grey.data());
  }
  profile.lines = static_cast<int>(seen_count);
  for (double& mean : profile.grey) {
    mean /= std::max(profile.lines, 1);
  }
  return profile;
}

}  // namespace luminav
