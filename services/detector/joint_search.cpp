#include "services/detector/joint_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace luminav {
namespace {

constexpr int kMargin = 4;           // steps beyond the places searched
constexpr double kLeastDepth = 3.0;  // [grey]
constexpr double kSigmas = 4.0;

struct Line {
  double middle;  // [steps]
  double end;     // [steps]
  double depth;   // [grey]
};

SideProfile profile_beyond(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                           const JointSearch& search, double corner) {
  const double span = search.farthest - search.nearest + 2.0 * kMargin * SideProfile::kStep;
  return mean_profile(image, camera, side,
                      {.first = search.nearest - kMargin * SideProfile::kStep,
                       .steps = static_cast<std::size_t>(span / SideProfile::kStep) + 1,
                       .from = corner * (side.half_length + search.from_corner),
                       .apart = corner * search.apart,
                       .count = search.lines});
}

/// The deepest dark line of a profile.
std::optional<Line> deepest_line(const SideProfile& profile, double least_depth) {
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
      line = {static_cast<double>(k), end, depth};
    }
  }
  return line;
}

}  // namespace

JointBeside find_joint_beside(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                              const JointSearch& search) {
  JointBeside beside;
  Line sum{0.0, 0.0, 0.0};
  int count = 0;
  for (const double corner : {1.0, -1.0}) {
    const SideProfile profile = profile_beyond(image, camera, side, search, corner);
    if (profile.lines < search.lines / 2) {
      continue;
    }
    beside.is_in_view = true;
    const double least = std::max(kLeastDepth, kSigmas * search.noise / std::sqrt(3.0 * profile.lines));
    if (const auto line = deepest_line(profile, least)) {
      sum.middle += line->middle;
      sum.end += line->end;
      sum.depth += line->depth;
      ++count;
    }
  }
  if (count > 0) {
    beside.found = true;
    beside.middle = search.nearest + SideProfile::kStep * (sum.middle / count - kMargin);
    beside.end = search.nearest + SideProfile::kStep * (sum.end / count - kMargin);
    beside.depth = sum.depth / count;
  }
  return beside;
}

}  // namespace luminav
