#include "services/detector/joint_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "services/common/geometry/vector_clones.hpp"
#include "services/detector/pixel_sampling.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kStep = 0.004;  // [m] across a joint, about a pixel
constexpr int kMargin = 4;       // steps beyond the places searched
constexpr std::size_t kMostSteps = 40;
static_assert(kMostSteps % 8 == 0);
constexpr double kApart = 0.012;     // [m] between lines along the side
constexpr int kLines = 16;           // beyond each corner
constexpr double kLeastDepth = 3.0;  // [grey]
constexpr double kSigmas = 4.0;

struct Profile {
  std::array<double, kMostSteps> grey{};
  std::size_t steps = 0;
  int lines = 0;
};

struct Line {
  double middle;  // [steps]
  double end;     // [steps]
};

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

Profile profile_beyond(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                       const JointSearch& search, double corner) {
  Profile profile;
  const PointTransform pose(side.pose);
  const double first = side.distance + search.nearest - kMargin * kStep;
  const double span = search.farthest - search.nearest + 2.0 * kMargin * kStep;
  profile.steps = std::min(kMostSteps, static_cast<std::size_t>(span / kStep) + 1);
  const double length = kStep * static_cast<double>(profile.steps - 1);
  std::array<Vector2d, 2 * kLines> places;
  for (std::size_t i = 0; i < kLines; ++i) {
    const Vector2d place =
        corner * (side.half_length + search.from_corner + kApart * static_cast<double>(i)) * side.along;
    places[2 * i] = pose * (place + first * side.out);
    places[2 * i + 1] = pose * (place + (first + length) * side.out);
  }
  std::array<Vector2d, 2 * kLines> pixels;
  camera.pixels_of_ceiling_points(places, side.height, pixels);
  for (std::size_t i = 0; i < kLines; ++i) {
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

/// The deepest dark line of a profile.
std::optional<Line> deepest_line(const Profile& profile, double least_depth) {
  const auto& grey = profile.grey;
  double deepest = least_depth;
  std::optional<Line> line;
  for (std::size_t k = kMargin; k + kMargin < profile.steps; ++k) {
    const double bottom = (grey[k - 1] + grey[k] + grey[k + 1]) / 3.0;
    const double after = 0.5 * (grey[k + 3] + grey[k + 4]);
    const double depth = std::min(0.5 * (grey[k - 4] + grey[k - 3]), after) - bottom;
    if (depth <= deepest) {
      continue;
    }
    const double half = 0.5 * (std::min(grey[k], bottom) + after);
    std::size_t i = k;
    while (i + 1 < profile.steps && grey[i + 1] < half) {
      ++i;
    }
    if (i + 1 < profile.steps) {
      deepest = depth;
      const double end = static_cast<double>(i) + (half - grey[i]) / (grey[i + 1] - grey[i]);
      line = {static_cast<double>(k), end};
    }
  }
  return line;
}

}  // namespace

JointBeside find_joint_beside(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                              const JointSearch& search) {
  JointBeside beside;
  Line sum{0.0, 0.0};
  int count = 0;
  for (const double corner : {1.0, -1.0}) {
    const Profile profile = profile_beyond(image, camera, side, search, corner);
    if (profile.lines < kLines / 2) {
      continue;
    }
    beside.is_in_view = true;
    const double least = std::max(kLeastDepth, kSigmas * search.noise / std::sqrt(3.0 * profile.lines));
    if (const auto line = deepest_line(profile, least)) {
      sum.middle += line->middle;
      sum.end += line->end;
      ++count;
    }
  }
  if (count > 0) {
    beside.found = true;
    beside.middle = search.nearest + kStep * (sum.middle / count - kMargin);
    beside.end = search.nearest + kStep * (sum.end / count - kMargin);
  }
  return beside;
}

}  // namespace luminav
