#include "services/detector/validation/candidate_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "services/detector/sampling/mean_profile.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::array kBothSides{1.0, -1.0};
constexpr double kBlurredEdge = 2.5;    // [px] by which an outline may always miss, however coarse the pixels
constexpr double kMaxAcross = 0.030;    // [m] 1 sigma of its place across
constexpr double kMinAcross = 16.0;     // [px] of what is no speck
constexpr double kOfMinVisible = 0.75;  // edges are looked for no closer to the border than this leaves
constexpr double kAlikeSides = 0.5;     // least step of a lamp's side, of the other's: a burning half has a faint one
constexpr double kMinUnlitQuality = 0.88;  // what shows fewer edges is mostly no fixture
constexpr double kMinSunk = 0.04;          // of the ceiling's grey level, by which what is unlit is darker
// Each amiss by 1:
constexpr double kMaxBesides = 0.30;  // share of the ring that is as bright: panes of a skylight lie in rows
constexpr double kFull = 0.80;  // of its rectangle, what a region fills; round ends and slanting cells leave a rest
constexpr double kMaxHollow = 0.20;
constexpr double kMaxDimmer = 0.5;        // than the brightest cells in view, of their grey level
constexpr double kMaxWithoutEdge = 0.25;  // share of the outline
// Where much is saturated, it says little that a lamp is, too, and what is lit is as bright as a lamp.
constexpr double kMuchWhite = 0.08;   // share of the cells
constexpr double kOverexposed = 0.2;  // share of the cells
constexpr double kMaxOverexposed = 0.4;
constexpr double kMaxAmissOfSpeck = 0.8;    // sizes of a few pixels say little
constexpr double kMaxAmiss = 1.0;           // in sum
constexpr double kMaxAmissOfPiece = 0.42;   // its length says nothing
constexpr double kRelativeContrast = 0.45;  // of a lamp above its surroundings, of its own grey level
constexpr double kWhiteContrast = 0.15;     // the same of one that is white, whose edges aren't known
constexpr double kSaturated = 250.0;        // [grey]
constexpr double kRingDistance = 0.35;      // of the width

bool is_bar(const Candidate& candidate) {
  return candidate.hypothesis.outline.shape != FixtureShape::kRound;
}

/// A disc of a few pixels: any crumb looks like it.
bool is_speck(const Candidate& candidate) {
  const Outline& outline = candidate.hypothesis.outline;
  return outline.shape == FixtureShape::kRound && outline.length < kMinAcross * candidate.fit.metres_per_px;
}

/// Wide enough to tell tubes from what lies between them.
bool shows_strips(const CeilingFrame& frame, const Candidate& candidate) {
  constexpr double kCells = 7.0;
  return candidate.bright && is_bar(candidate) &&
         candidate.hypothesis.outline.width > kCells * frame.factor * candidate.fit.metres_per_px;
}

}  // namespace

Verdict CandidateChecks::by_edges(const CeilingFrame& frame, const Candidate& candidate) const {
  if (!has_right_size(candidate)) {
    return Verdict::kWrongSize;
  }
  Verdict verdict = is_bar(candidate) ? sides(candidate) : disc(candidate);
  if (verdict == Verdict::kAccepted && is_bar(candidate)) {
    verdict = ends(candidate);
  }
  if (verdict == Verdict::kAccepted && is_bar(candidate) && candidate.fit.ends_visible() < 2) {
    verdict = piece(candidate);
  }
  if (verdict != Verdict::kAccepted) {
    return verdict;
  }
  if (!candidate.bright && candidate.fit.quality() < kMinUnlitQuality) {
    return Verdict::kTooFewEdges;
  }
  if (is_bar(candidate) && candidate.fit.covariance(1, 1) > kMaxAcross * kMaxAcross) {
    return Verdict::kTooUncertain;
  }
  if (!candidate.bright && !frame.is_negative && is_bar(candidate) && !is_sunk(frame, candidate)) {
    return Verdict::kNoContrast;
  }
  if (other_kinds_.may_be(frame, candidate)) {
    return Verdict::kMayBeAnother;
  }
  return candidate.bright ? contrast(frame, candidate) : Verdict::kAccepted;
}

/// Darker than what lies beyond its sides, even the two of which that is least true: light slopes from one to the
/// other. A tile of the ceiling has lines all round as well, and no step.
bool CandidateChecks::is_sunk(const CeilingFrame& frame, const Candidate& candidate) const {
  constexpr double kBeside = 0.025;  // [m] beyond the edge: a line between tiles and its blur
  constexpr double kFarthest = 0.065;
  constexpr double kDeepest = 0.09;
  const Outline& outline = candidate.hypothesis.outline;
  const OutlinePlacement& placement = candidate.fit.placement;
  std::array steps{1.0, 1.0, 1.0, 1.0};  // by which it is darker there; out of view it may be as dark as can be
  for (const int side : {kLeftSide, kRightSide, kFarEnd, kNearEnd}) {
    if (candidate.fit.sides[static_cast<std::size_t>(side)].in_view < 3) {
      continue;
    }
    const bool is_end = side == kFarEnd || side == kNearEnd;
    const double sign = side == kLeftSide || side == kFarEnd ? 1.0 : -1.0;
    const double half =
        is_end ? 0.5 * outline.length + placement.end_outset : 0.5 * outline.width + placement.side_outset;
    const double length = 0.84 * (is_end ? outline.width : outline.length);
    const double inner = -std::clamp(half, SideProfile::kStep, kDeepest);
    const SideProfile profile = mean_profile(frame.image, camera_,
                                             {.pose = placement.pose,
                                              .height = outline.height,
                                              .along = is_end ? Vector2d::UnitY() : Vector2d::UnitX(),
                                              .out = sign * (is_end ? Vector2d::UnitX() : Vector2d::UnitY())},
                                             {.first = half + inner,
                                              .steps = SideProfile::kMaxSteps,
                                              .from = -0.5 * length,
                                              .apart = length / (SideProfile::kMaxLines - 1),
                                              .count = SideProfile::kMaxLines});
    const auto mean = [&](double from, double to) {
      const auto at = [&](double out) {
        return profile.grey.begin() + std::lround((out - inner) / SideProfile::kStep);
      };
      return std::accumulate(at(from), at(to) + 1, 0.0) / static_cast<double>(at(to) + 1 - at(from));
    };
    if (profile.lines > 0) {
      const double beyond = mean(kBeside, kFarthest);
      steps[static_cast<std::size_t>(side)] = 1.0 - mean(inner, 0.5 * inner) / std::max(beyond, 1.0);
    }
  }
  std::sort(steps.begin(), steps.end());
  return steps[0] + steps[1] > 2.0 * kMinSunk;
}

bool CandidateChecks::lies_between_shadows(const CeilingFrame& frame, const Candidate& candidate) const {
  constexpr double kInside = 0.02;     // [m] from the edge inwards, where the profile begins
  constexpr double kMinCeiling = 0.9;  // beyond the shadow, of the batten's grey level
  constexpr double kMaxCeiling = 1.15;
  constexpr double kMaxShade = 0.97;
  constexpr double kMinShade = 0.7;  // of the ceiling's grey level: light comes from all around
  const Outline& outline = candidate.hypothesis.outline;
  return std::all_of(kBothSides.begin(), kBothSides.end(), [&](double side) {
    const SideProfile profile =
        mean_profile(frame.image, camera_,
                     {candidate.fit.placement.pose, outline.height, Vector2d::UnitX(), side * Vector2d::UnitY()},
                     {.first = 0.5 * outline.width - kInside,
                      .steps = SideProfile::kMaxSteps,
                      .from = -0.45 * outline.length,
                      .apart = 0.9 * outline.length / (SideProfile::kMaxLines - 1),
                      .count = SideProfile::kMaxLines});
    const auto grey_at = [&](double out) {
      return 255.0 - profile.grey[static_cast<std::size_t>((out + kInside) / SideProfile::kStep)];
    };
    const double shade = grey_at(0.02);
    const double ceiling = grey_at(0.11);
    return profile.lines > 0 && shade > kMinShade * ceiling && shade < kMaxShade * ceiling &&
           2.0 * grey_at(0.06) > shade + ceiling && ceiling > kMinCeiling * grey_at(-kInside) &&
           ceiling < kMaxCeiling * grey_at(-kInside);
  });
}

Verdict CandidateChecks::by_region(const CeilingFrame& frame, const Candidate& candidate) const {
  if (is_speck(candidate) || (frame.saturated > kMuchWhite && candidate.level < kSaturated)) {
    return Verdict::kTooUncertain;
  }
  return contrast(frame, candidate);
}

/// A lamp is of the right size, fills its outline, is among the brightest things in view and far brighter than what
/// surrounds it, which has nothing like it. Each may be a little amiss, not all of them. A region of a few cells is
/// ragged: what has an edge wherever one was looked for fills its outline all the same.
Verdict CandidateChecks::contrast(const CeilingFrame& frame, const Candidate& candidate) const {
  const Surroundings around = surroundings(frame, candidate);
  const double above = around.inside - around.ring;
  const double relative = around.inside < kSaturated ? kRelativeContrast : candidate.by_edges ? 0.0 : kWhiteContrast;
  if (around.in_view > 0 && above < std::max(params_.lit_contrast, relative * around.inside)) {
    return Verdict::kNoContrast;
  }
  const bool is_outlined = candidate.by_edges && candidate.fit.quality() == 1.0;
  const double amiss =
      candidate.hypothesis.size_error / params_.size_tolerance + around.bright_share / kMaxBesides +
      (is_outlined ? 0.0 : std::max(0.0, kFull - candidate.hypothesis.fill) / kMaxHollow) +
      (1.0 - around.inside / frame.brightest) / kMaxDimmer +
      (candidate.by_edges ? (1.0 - candidate.fit.quality()) / kMaxWithoutEdge : 0.0) +
      (candidate.by_edges && candidate.is_whole() ? std::min(kMaxOverexposed, frame.saturated / kOverexposed) : 0.0);
  const double most = !candidate.is_whole() ? kMaxAmissOfPiece : is_speck(candidate) ? kMaxAmissOfSpeck : kMaxAmiss;
  return amiss > most ? Verdict::kMuchAmiss : Verdict::kAccepted;
}

bool CandidateChecks::has_right_size(const Candidate& candidate) const {
  const Outline& outline = candidate.hypothesis.outline;
  const OutlineFit& fit = candidate.fit;
  const double side = fit.placement.side_outset;
  const double end = fit.placement.end_outset;
  const double blurred = kBlurredEdge * fit.metres_per_px;
  const double of_width = 0.5 * params_.size_tolerance * outline.width + blurred;
  const double bloom = candidate.bright ? params_.max_bloom : 0.0;
  const double longer = outline.shape == FixtureShape::kRound ? 0.0
                        : candidate.bright                    ? end - std::max(side, 0.0)
                                                              : end;
  return side > -of_width && side < of_width + bloom &&
         std::abs(longer) < 0.5 * params_.size_tolerance * outline.length + blurred;
}

Verdict CandidateChecks::disc(const Candidate& candidate) const {
  const OutlineFit& fit = candidate.fit;
  const SideEdges& rim = fit.sides[kLeftSide];
  const bool sound = rim.in_view >= 12 && 2 * rim.in_view >= rim.expected && rim.share() >= params_.min_side_support;
  return sound ? Verdict::kAccepted : Verdict::kNoLongSide;
}

Verdict CandidateChecks::sides(const Candidate& candidate) const {
  const OutlineFit& fit = candidate.fit;
  const SideEdges& left = fit.sides[kLeftSide];
  const SideEdges& right = fit.sides[kRightSide];
  const std::optional<Side> only = fit.only_side();
  const double length = candidate.hypothesis.outline.length;
  const double min_stretch = kOfMinVisible * params_.min_visible * length;
  if (only) {
    if (candidate.hypothesis.burning > 0 || fit.sides[*only].in_view < 8 ||
        fit.visible_to - fit.visible_from < min_stretch) {
      return Verdict::kTooLittleInView;
    }
    return fit.share(*only) < params_.min_side_support ? Verdict::kNoLongSide : Verdict::kAccepted;
  }
  const double from = fit.end_visible(kNearEnd) ? -0.5 * length : fit.visible_from;
  const double to = fit.end_visible(kFarEnd) ? 0.5 * length : fit.visible_to;
  if (std::min(left.in_view, right.in_view) < 3 || to - from < min_stretch) {
    return Verdict::kTooLittleInView;
  }
  if (std::min(left.share(), right.share()) < params_.min_side_support) {
    return Verdict::kNoLongSide;
  }
  const double least = candidate.bright ? kAlikeSides : 0.0;
  return std::min(left.step, right.step) < least * std::max(left.step, right.step) ? Verdict::kUnequalSides
                                                                                   : Verdict::kAccepted;
}

Verdict CandidateChecks::ends(const Candidate& candidate) const {
  const OutlineFit& fit = candidate.fit;
  for (const int end : {kFarEnd, kNearEnd}) {
    if (fit.sides[static_cast<std::size_t>(end)].in_view >= 3 && fit.share(end) < params_.min_end_support) {
      return Verdict::kNoEnd;
    }
  }
  return Verdict::kAccepted;
}

/// The border cuts it, or hides an end in noise. Grooves and beams have two dark edges.
Verdict CandidateChecks::piece(const Candidate& candidate) const {
  const OutlineFit& fit = candidate.fit;
  if (candidate.hypothesis.outline.shape == FixtureShape::kSquare && !fit.only_side()) {
    return Verdict::kTooFewEdges;
  }
  const int edges = fit.ends_visible() + (fit.only_side() ? 1 : 2);
  return edges < (candidate.bright ? 2 : 3) ? Verdict::kTooFewEdges : Verdict::kAccepted;
}

/// Tubes have bars and reflectors between them: either half of a lamp is as bright as its brightest strip there, and
/// the lamp as its dimmer half; of a narrow one, as its middle.
std::optional<int> CandidateChecks::level_across(const CeilingFrame& frame, const Candidate& candidate,
                                                 const PointTransform& pose, double along) const {
  constexpr std::array kPlaces{0.125, 0.25, 0.375};  // of the width
  if (!shows_strips(frame, candidate)) {
    return level_at(frame, camera_, candidate, pose, {along, 0.0});
  }
  std::array<std::optional<int>, 2> brightest;
  for (const double place : kPlaces) {
    for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
      const double across = (half == 0 ? place : -place) * candidate.hypothesis.outline.width;
      brightest[half] = std::max(brightest[half], level_at(frame, camera_, candidate, pose, {along, across}));
    }
  }
  return brightest[0] && brightest[1] ? std::min(brightest[0], brightest[1]) : std::max(brightest[0], brightest[1]);
}

CandidateChecks::Surroundings CandidateChecks::surroundings(const CeilingFrame& frame,
                                                            const Candidate& candidate) const {
  constexpr int kPlaces = 12;  // along each side
  const Outline& outline = candidate.hypothesis.outline;
  const OutlinePlacement& placement = candidate.fit.placement;
  const PointTransform pose(placement.pose);
  const double cell = frame.factor * candidate.fit.metres_per_px;
  const double half_length = 0.5 * outline.length + placement.end_outset;
  const double half_width = 0.5 * outline.width + placement.side_outset;
  const double apart = std::max(kRingDistance * outline.width, 2.0 * cell);
  Surroundings result;
  double inside = 0.0;
  int looked = 0;
  int bright = 0;
  const auto look_outside = [&](const Vector2d& place, bool beyond_end = false) {
    if (const auto grey = level_at(frame, camera_, candidate, pose, place)) {
      result.ring += *grey;
      bright += *grey > candidate.level && !(beyond_end && candidate.by_edges) ? 1 : 0;
      ++result.in_view;
    }
  };
  const bool round = outline.shape == FixtureShape::kRound;
  for (int i = 0; i < kPlaces; ++i) {
    const double t = (i + 0.5) / kPlaces - 0.5;
    const std::optional<int> grey = round ? level_at(frame, camera_, candidate, pose, {0.7 * outline.length * t, 0.0})
                                          : level_across(frame, candidate, pose, 0.9 * outline.length * t);
    inside += grey.value_or(0);
    looked += grey ? 1 : 0;
    for (const double out : {apart, 2.0 * apart}) {
      if (round) {
        const double radius = half_width + out;
        look_outside(radius * Vector2d(std::cos(2.0 * kPi * t), std::sin(2.0 * kPi * t)));
        continue;
      }
      for (const double side : {1.0, -1.0}) {
        if (candidate.hypothesis.drowned == (side > 0.0 ? kLeftSide : kRightSide)) {
          continue;
        }
        look_outside({2.0 * half_length * t, side * (half_width + out)});
        if (i % 4 == 1) {  // ends are shorter
          look_outside({side * (half_length + out), 2.0 * half_width * t}, true);
        }
      }
    }
  }
  result.inside = inside / std::max(looked, 1);
  result.ring /= std::max(result.in_view, 1);
  result.bright_share = static_cast<double>(bright) / std::max(result.in_view, 1);
  return result;
}

}  // namespace luminav
