#include "services/detector/validation/other_kinds.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/detector/sampling/mean_profile.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kOtherWidth = 0.03;  // [m] by which widths of kinds differ

}  // namespace

bool OtherKinds::may_be(const CeilingFrame& frame, const Candidate& candidate) const {
  const OutlineFit& fit = candidate.fit;
  const Outline& outline = candidate.hypothesis.outline;
  if (outline.shape == FixtureShape::kRound) {
    return false;
  }
  if (is_as_large_as_a_vent(candidate) && is_striped(frame, candidate)) {
    return true;
  }
  const std::optional<Side> only = fit.only_side();
  if (fit.ends_visible() == 2 && !only) {
    return false;
  }
  if (!only && is_of_other_height(candidate)) {
    return true;
  }
  const bool is_whole_side = fit.ends_visible() == 2;
  const double seen =
      is_whole_side ? outline.length + 2.0 * fit.placement.end_outset : fit.visible_to - fit.visible_from;
  const double bloom = candidate.bright ? 2.0 * max_bloom_ : 0.0;
  const double slack = is_whole_side ? 2.0 * kOtherWidth : kOtherWidth;
  const auto may_be = [&](double length, double width) {
    if (length < seen - bloom - slack || (is_whole_side && length > seen + slack)) {
      return false;
    }
    return only ? width > outline.width - kOtherWidth || !reaches_beyond(frame, candidate, *only, width)
                : std::abs(width - outline.width) < kOtherWidth + 0.1 * outline.width;
  };
  for (const CeilingKind& element : catalogue_.elements) {
    if ((element.luminous || !candidate.bright) &&
        (may_be(element.length, element.width) || may_be(element.width, element.length)) &&
        !(element.slatted && !is_striped(frame, candidate))) {
      return true;
    }
  }
  return only && std::any_of(catalogue_.fixtures.begin(), catalogue_.fixtures.end(), [&](const CeilingKind& kind) {
           const bool is_bar = kind.shape == FixtureShape::kRectangle;
           const bool is_other =
               kind.shape != FixtureShape::kRound && std::abs(kind.width - outline.width) > kOtherWidth;
           return (is_other && may_be(kind.length, kind.width)) || (is_bar && may_be(kind.width, kind.length)) ||
                  (is_bar && candidate.bright && kind.lamps >= 2 && may_be(kind.length, 0.5 * kind.width));
         });
}

bool OtherKinds::is_as_large_as_a_vent(const Candidate& candidate) const {
  const Outline& outline = candidate.hypothesis.outline;
  const auto is_alike = [](double a, double b) { return std::abs(a - b) < kOtherWidth + 0.1 * b; };
  return !candidate.bright &&
         std::any_of(catalogue_.elements.begin(), catalogue_.elements.end(), [&](const CeilingKind& element) {
           return element.slatted && is_alike(element.length, outline.length) && is_alike(element.width, outline.width);
         });
}

bool OtherKinds::is_of_other_height(const Candidate& candidate) const {
  constexpr double kOtherHeight = 0.1;  // [m]
  const Outline& outline = candidate.hypothesis.outline;
  const double lens = camera_.mounting().z;
  const double own_error = 2.0 * std::abs(candidate.fit.placement.side_outset);
  const double seen = outline.width + 2.0 * candidate.fit.placement.side_outset;
  return std::any_of(catalogue_.fixtures.begin(), catalogue_.fixtures.end(), [&](const CeilingKind& kind) {
    const double width = kind.width * (outline.height - lens) / (kind.height - lens);
    return kind.shape != FixtureShape::kRound && std::abs(kind.height - outline.height) > kOtherHeight &&
           std::abs(seen - width) < own_error;
  });
}

/// Slats of a vent show along or across: a mean profile that is rougher than noise makes it.
bool OtherKinds::is_striped(const CeilingFrame& frame, const Candidate& candidate) const {
  constexpr double kRim = 0.045;   // [m] beside an edge: blur, and a vent's plain frame
  constexpr double kRough = 0.16;  // of the step at the edges; slats reach 0.3
  constexpr std::size_t kHalfWindow = 8;
  constexpr int kLines = 16;
  const OutlineFit& fit = candidate.fit;
  const Outline& outline = candidate.hypothesis.outline;
  const double along = fit.visible_to - fit.visible_from - 2.0 * kRim;
  const double across = outline.width - 2.0 * kRim;
  const Pose2 middle = fit.placement.pose * Pose2{0.5 * (fit.visible_from + fit.visible_to), 0.0, 0.0};
  const auto roughness = [&](const Vector2d& out, double extent, double breadth) {
    const auto steps = static_cast<std::size_t>(std::clamp(extent / SideProfile::kStep, 0.0, 40.0));
    const SideProfile profile = mean_profile(frame.image, camera_, {middle, outline.height, {out.y(), out.x()}, out},
                                             {.first = -0.5 * SideProfile::kStep * static_cast<double>(steps),
                                              .steps = steps,
                                              .from = -0.5 * breadth,
                                              .apart = breadth / (kLines - 1),
                                              .count = kLines});
    double squares = 0.0;
    int count = 0;
    for (std::size_t k = kHalfWindow / 2; profile.lines > kLines / 2 && k + kHalfWindow / 2 < profile.steps; ++k) {
      const auto first = profile.grey.begin() + static_cast<std::ptrdiff_t>(k - kHalfWindow / 2);
      const double mean = std::accumulate(first, first + kHalfWindow + 1, 0.0) / (kHalfWindow + 1);
      squares += std::pow(profile.grey[k] - mean, 2);
      ++count;
    }
    return count == 0 ? 1e9 : std::sqrt(squares / count);
  };
  const double noise = frame.pixel_noise / std::sqrt(1.0 * kLines);
  return std::max(roughness(Vector2d::UnitX(), along, across), roughness(Vector2d::UnitY(), across, along)) >
         std::hypot(kRough * fit.step(), noise);
}

/// True when it is as bright, or dark, from beyond where a narrower thing and its blur would end to the border.
bool OtherKinds::reaches_beyond(const CeilingFrame& frame, const Candidate& candidate, Side side, double width) const {
  constexpr int kPlaces = 32;
  constexpr double kStep = 0.02;  // [m]
  const Outline& outline = candidate.hypothesis.outline;
  const PointTransform pose(candidate.fit.placement.pose);
  const double outwards = side == kLeftSide ? 1.0 : -1.0;
  const double blur = candidate.bright ? 6.0 * candidate.fit.metres_per_px : 0.03;
  int alike = 0;
  int looked = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double along = 0.92 * outline.length * ((i + 0.5) / kPlaces - 0.5);
    const auto level = [&](double depth) {
      return level_at(frame, camera_, candidate, pose, {along, outwards * (0.5 * outline.width - depth)});
    };
    const auto inside = level(0.5 * width);
    std::optional<int> beyond;
    for (double depth = width + blur; depth < 0.9 * outline.width && level(depth); depth += kStep) {
      beyond = level(depth);
    }
    if (inside && beyond) {
      ++looked;
      alike += *beyond > (candidate.bright ? 0.88 : 0.5) * *inside ? 1 : 0;
    }
  }
  return looked >= 6 && 10 * alike >= 9 * looked;
}

}  // namespace luminav
