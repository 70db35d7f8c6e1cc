#include "services/detector/candidate_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "services/detector/one_side.hpp"
#include "services/detector/surface_texture.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr std::array<Side, 2> kEnds{kFarEnd, kNearEnd};
constexpr double kBlurredEdge = 2.5;   // [px] by which an outline may always miss, however coarse the pixels
constexpr double kFitted = 0.020;      // [m] by which bloom may be wider than it was proposed
constexpr double kMostAcross = 0.030;  // [m] 1 sigma of its place across
constexpr double kLeastDisc = 16.0;    // [px] across: smaller ones must be lit, with an edge nearly all round
constexpr double kSpeckFit = 0.92;
constexpr double kOfLeastVisible = 0.85;  // so close to the border no edges are looked for
constexpr double kOfLeastWithEnd = 0.55;  // where the border runs across a lamp, one side is longer than that
constexpr double kAlikeSides = 0.6;       // least step of a side, of the other's
constexpr double kSureSides = 0.79;       // share of both sides and of one end, where the other end is noisy
// Of a fixture whose other long side is out of view:
constexpr double kLeastStretch = 0.4;  // of the side that is seen, or of an unlit piece without ends
constexpr double kLeastOfLamp = 0.32;  // of the length, of a lit piece without ends
constexpr double kOneSideFit = 0.85;   // share of it that must show its edge
constexpr double kMostHeading = radians(0.7);
// Of an unlit fixture without ends, the least depth of its outermost stretches against that of the others: joints carry
// its long sides on beyond an end that is in view (there 0 to 0.57, up to the border 0.73 to 1.0; simulated pictures).
constexpr double kGoesOn = 0.6;

// Step of one side, of the other's: 0.88 to 1.0 of lamps, to 0.75 of the burning half beside a dark one (simulated
// pictures).
constexpr double kSameLight = 0.8;
constexpr double kOtherWidth = 0.03;  // [m] by which widths of kinds differ
constexpr int kSaturated = 225;       // [grey] what is filled above that has no dark half

/// [m] of the length that is in the image; edge points leave out the corners of lit ones.
double length_in_view(const OutlineFit& fit, const Outline& outline) {
  const double from = fit.end_visible(kNearEnd) ? -0.5 * outline.length : fit.visible_from;
  const double to = fit.end_visible(kFarEnd) ? 0.5 * outline.length : fit.visible_to;
  return to - from;
}

/// True when an end shows its edge over three quarters of it or more.
bool shows_an_end(const OutlineFit& fit) {
  return std::any_of(kEnds.begin(), kEnds.end(),
                     [&](Side end) { return fit.end_visible(end) && 4 * fit.on_edge[end] >= 3 * fit.expected[end]; });
}

/// True when a long side of which only a point or two are in view shows its edge there, and an end reaches up to it.
/// `by_light`: the width may be that of a burning half, whose inner side is fainter.
bool shows_its_width(const OutlineFit& fit, Side only_side, bool by_light) {
  const auto other = static_cast<std::size_t>(only_side == kLeftSide ? kRightSide : kLeftSide);
  const auto [least, most] = std::minmax(fit.side_step[kLeftSide], fit.side_step[kRightSide]);
  return shows_an_end(fit) && fit.in_view[other] > 0 && fit.on_edge[other] == fit.in_view[other] &&
         (!by_light || least > kSameLight * most);
}

/// True when half of a listed fixture of two lamps is as wide.
bool may_be_half(const CeilingCatalogue& catalogue, double width) {
  return std::any_of(catalogue.fixtures.begin(), catalogue.fixtures.end(), [&](const CeilingKind& kind) {
    return kind.lamps >= 2 && std::abs(0.5 * kind.width - width) < kOtherWidth;
  });
}

/// True when a burning end shows its edge all across, and all of what both long sides show of theirs.
bool is_sure_of_its_end(const OutlineFit& fit) {
  const auto all = [&](Side side) { return fit.on_edge[side] == fit.in_view[side]; };
  return all(kLeftSide) && all(kRightSide) && std::any_of(kEnds.begin(), kEnds.end(), [&](Side end) {
           return fit.end_visible(end) && fit.on_edge[end] == fit.expected[end];
         });
}

}  // namespace

const char* CandidateChecks::objection(const CeilingFrame& frame, const Candidate& candidate, int level) const {
  const bool bright = level > 0;
  const OutlineFit& fit = candidate.fit;
  const Outline& outline = candidate.hypothesis.outline;
  const double of_pixels = kBlurredEdge * fit.metres_per_px;
  const double most = std::max(bright ? params_.largest_bloom + kFitted : params_.largest_misfit, of_pixels);
  const double least = candidate.hypothesis.is_element ? -kElementFrame
                       : bright                        ? -std::max(0.010, of_pixels)
                                                       : -std::max(params_.largest_misfit, of_pixels);
  if (fit.swelling > most || fit.swelling < least) {
    return "too wide or too narrow";
  }
  if (outline.shape == FixtureShape::kRound) {
    return objection_to_disc(frame, candidate, level);
  }
  const std::optional<Side> only_side = fit.only_side();
  const bool one_side =
      only_side &&
      !(bright && shows_its_width(fit, *only_side, level < kSaturated || may_be_half(catalogue_, outline.width)));
  if (const char* why =
          one_side ? objection_to_one_side(candidate, *only_side, bright) : objection_to_edges(candidate, level)) {
    return why;
  }
  if (!bright && !(ends_where_it_says(frame, candidate, kFarEnd) && ends_where_it_says(frame, candidate, kNearEnd))) {
    return "goes on beyond its end";
  }
  const int ends = (fit.end_visible(kFarEnd) ? 1 : 0) + (fit.end_visible(kNearEnd) ? 1 : 0);
  if (candidate.hypothesis.is_element && ends < 2) {
    return "an element that is cut";
  }
  // A guess from one edge, cut on top of that, must at least stand out alike on both sides.
  if (candidate.hypothesis.from_edge && ends < 2 &&
      std::min(fit.side_step[kLeftSide], fit.side_step[kRightSide]) <
          kAlikeSides * std::max(fit.side_step[kLeftSide], fit.side_step[kRightSide])) {
    return "sides of different brightness";
  }
  const double seen = (fit.visible_to - fit.visible_from) / outline.length;
  const bool short_piece = ends < 1 && seen < kLeastStretch;
  if (outline.shape == FixtureShape::kSquare ? ends < 2 : short_piece && (!bright || seen < kLeastOfLamp)) {
    return "too few ends";
  }
  if (short_piece && fit.covariance(2, 2) > kMostHeading * kMostHeading) {
    return "too uncertain";
  }
  if (!is_filled(frame, candidate, level)) {
    return kNotFilled.data();
  }
  if (!bright && ends == 0 && !goes_on_to_the_border(frame, candidate)) {
    return "ends within the image";
  }
  if (!candidate.hypothesis.is_element && fit.covariance(1, 1) > kMostAcross * kMostAcross) {
    return "too uncertain";
  }
  if (one_side) {
    const PieceFromOneSide piece(frame, camera_, candidate, *only_side, bright);
    return !piece.stands_out()                ? "no brighter or darker than its surroundings"
           : piece.may_be_another(catalogue_) ? kMayBeAnother.data()
                                              : nullptr;
  }
  return may_be_something_else(frame, candidate, bright) ? "may be another element" : nullptr;
}

std::optional<NarrowerReading> CandidateChecks::rare_narrower(const CeilingFrame& frame,
                                                              const Candidate& candidate) const {
  const std::optional<Side> side = candidate.fit.only_side();
  return side ? PieceFromOneSide(frame, camera_, candidate, *side, true).rare_narrower(catalogue_) : std::nullopt;
}

const char* CandidateChecks::objection_to_disc(const CeilingFrame& frame, const Candidate& candidate, int level) const {
  const bool bright = level > 0;
  const OutlineFit& fit = candidate.fit;
  const Outline& outline = candidate.hypothesis.outline;
  // A disc of a few pixels: any dark speck or bright crumb looks like it.
  const bool speck = outline.length / fit.metres_per_px < kLeastDisc;
  if (speck && (!bright || fit.share(kLeftSide) < kSpeckFit)) {
    return "too small to tell";
  }
  const bool sound = fit.in_view[kLeftSide] >= 12 && 2 * fit.in_view[kLeftSide] >= fit.expected[kLeftSide] &&
                     fit.share(kLeftSide) >= params_.minimum_long_side_fit;
  return !sound ? "no edge all round" : !is_filled(frame, candidate, level) ? kNotFilled.data() : nullptr;
}

const char* CandidateChecks::objection_to_edges(const Candidate& candidate, int level) const {
  const bool bright = level > 0;
  const OutlineFit& fit = candidate.fit;
  const Outline& outline = candidate.hypothesis.outline;
  const int least = fit.only_side() ? 1 : 3;
  // Too little of a lamp tells whether it is half of a fixture.
  const bool may_be_short = level >= kSaturated && is_sure_of_its_end(fit) && !may_be_half(catalogue_, outline.width);
  const double least_length = may_be_short ? kOfLeastWithEnd : kOfLeastVisible;
  if (fit.in_view[kLeftSide] < least || fit.in_view[kRightSide] < least ||
      fit.in_view[kLeftSide] + fit.in_view[kRightSide] < 10 ||
      length_in_view(fit, outline) < least_length * params_.minimum_visible * outline.length) {
    return "too little in view";
  }
  if (fit.share(kLeftSide) < params_.minimum_long_side_fit || fit.share(kRightSide) < params_.minimum_long_side_fit) {
    return "no edge along a long side";
  }
  // The burning half of a fixture next to its dark half looks like a whole one with one faint side; the shadow between
  // a lamp's glow and a joint like an unlit one. Where all of the inside burns, a side is faint also because the
  // ceiling beside it is bright; an end tells that from daylight.
  const int ends = (fit.end_visible(kFarEnd) ? 1 : 0) + (fit.end_visible(kNearEnd) ? 1 : 0);
  const bool all_burns = level >= kSaturated && !candidate.hypothesis.half_width && ends == 1;
  const double least_share = all_burns ? 0.42 : bright ? 0.5 : ends == 2 ? 0.0 : 0.25;
  if (std::min(fit.side_step[kLeftSide], fit.side_step[kRightSide]) <
      least_share * std::max(fit.side_step[kLeftSide], fit.side_step[kRightSide])) {
    return "sides of different brightness";
  }
  return objection_to_ends(fit, bright);
}

const char* CandidateChecks::objection_to_one_side(const Candidate& candidate, Side side, bool bright) const {
  const OutlineFit& fit = candidate.fit;
  if (candidate.hypothesis.is_element || candidate.hypothesis.half_width) {
    return "one long side alone";
  }
  const Outline& outline = candidate.hypothesis.outline;
  // An end as wide as the outline says what it belongs to, unless the other side should show its edge as well: the end
  // itself, which a joint makes longer, may look like a side.
  const auto other = static_cast<std::size_t>(side == kLeftSide ? kRightSide : kLeftSide);
  const bool has_end = bright && shows_an_end(fit) && fit.on_edge[other] == fit.in_view[other];
  const bool enough = has_end ? length_in_view(fit, outline) >= params_.minimum_visible * outline.length
                              : fit.visible_to - fit.visible_from >= kLeastStretch * outline.length;
  if (fit.in_view[static_cast<std::size_t>(side)] < 10 || !enough) {
    return "too little in view";
  }
  if (fit.share(side) < std::max(kOneSideFit, params_.minimum_long_side_fit)) {
    return "no edge along a long side";
  }
  if (fit.covariance(2, 2) > kMostHeading * kMostHeading) {
    return "too uncertain";
  }
  return objection_to_ends(fit, bright);
}

const char* CandidateChecks::objection_to_ends(const OutlineFit& fit, bool bright) const {
  // A short end has few points, and noise may hide the edge of most: where both sides and the other end of an unlit one
  // are certain, how dark it is inside and outside of the end decides (`ends_where_it_says`).
  const bool whole = fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd);
  const bool sure_sides = !bright && whole && std::min(fit.share(kLeftSide), fit.share(kRightSide)) > kSureSides &&
                          std::max(fit.share(kFarEnd), fit.share(kNearEnd)) > kSureSides;
  for (const int end : {kFarEnd, kNearEnd}) {
    if (fit.in_view[static_cast<std::size_t>(end)] >= 3 && fit.share(end) < params_.minimum_end_fit && !sure_sides) {
      return "no edge at an end";
    }
    // A joint between tiles may look like an end; then the long sides don't reach it.
    const std::size_t corner = end == kFarEnd ? 0 : 1;
    if (fit.end_visible(end) && fit.corner_on_edge[corner] < 0.6 * fit.corner_in_view[corner]) {
      return "long sides end early";
    }
  }
  return nullptr;
}

bool CandidateChecks::may_be_something_else(const CeilingFrame& frame, const Candidate& candidate, bool bright) const {
  const OutlineFit& fit = candidate.fit;
  if (candidate.hypothesis.is_element || (fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd)) ||
      candidate.hypothesis.outline.shape == FixtureShape::kRound) {
    return false;
  }
  const double seen = fit.visible_to - fit.visible_from;
  const double width = candidate.hypothesis.outline.width;
  for (const CeilingKind& element : catalogue_.elements) {
    if (bright && !element.luminous) {
      continue;
    }
    const double slack = 0.03 + 0.1 * width;
    const bool lengthwise = std::abs(element.width - width) < slack && element.length > seen - 0.03;
    const bool crosswise = std::abs(element.length - width) < slack && element.width > seen - 0.03;
    if ((lengthwise || crosswise) &&
        !(element.slatted &&
          is_surely_smooth(frame.image, camera_, candidate.hypothesis.outline, fit, frame.pixel_noise))) {
      return true;
    }
  }
  return false;
}

bool CandidateChecks::ends_where_it_says(const CeilingFrame& frame, const Candidate& candidate, int end) const {
  if (!candidate.fit.end_visible(end)) {
    return true;
  }
  // Between 30 and 75 mm from the end: beyond blur and joints, nearer than anything else.
  constexpr std::array<double, 3> kDistances{0.030, 0.050, 0.075};  // [m]
  const Raster& contrast = frame.dark;
  const Outline& outline = candidate.hypothesis.outline;
  const PointTransform pose(candidate.fit.robot_from_outline);
  const double direction = end == kFarEnd ? 1.0 : -1.0;
  std::array<double, 2> sum{};  // inside, outside
  std::array<int, 2> count{};
  for (const double distance : kDistances) {
    for (const double across : {-0.3, -0.1, 0.1, 0.3}) {
      for (const std::size_t outside : {std::size_t{0}, std::size_t{1}}) {
        const double along = direction * (0.5 * outline.length + (outside == 1 ? distance : -distance));
        const Vector2d place(along, across * outline.width);
        const auto pixel = camera_.pixel_of_ceiling_point(pose * place, outline.height);
        if (pixel && camera_.is_in_image(*pixel, frame.factor)) {
          sum[outside] += cell_at(contrast, *pixel, frame.factor);
          ++count[outside];
        }
      }
    }
  }
  if (count[0] < 3 || count[1] < 3) {
    return true;  // out of view: nothing to say against it
  }
  const double inside = sum[0] / count[0];
  return inside - sum[1] / count[1] > 0.45 * std::max(inside, candidate.fit.step);
}

bool CandidateChecks::goes_on_to_the_border(const CeilingFrame& frame, const Candidate& candidate) const {
  constexpr std::size_t kStretches = 16;
  const Outline& outline = candidate.hypothesis.outline;
  const OutlineFit& fit = candidate.fit;
  const PointTransform pose(fit.robot_from_outline);
  std::array<double, kStretches> depth;  // mean [grey] of each that is in view
  std::size_t count = 0;
  for (std::size_t i = 0; i < kStretches; ++i) {
    const double along =
        fit.visible_from + (fit.visible_to - fit.visible_from) * (static_cast<double>(i) + 0.5) / kStretches;
    int sum = 0;
    int looked = 0;
    for (int j = -3; j <= 3; ++j) {
      const auto pixel =
          camera_.pixel_of_ceiling_point(pose * Vector2d(along, 0.1 * j * outline.width), outline.height);
      if (pixel && camera_.is_in_image(*pixel, frame.factor)) {
        sum += cell_at(frame.dark, *pixel, frame.factor);
        ++looked;
      }
    }
    if (looked > 0) {
      depth[count++] = static_cast<double>(sum) / looked;
    }
  }
  if (count == 0) {
    return false;
  }
  const double outermost = std::min(depth[0], depth[count - 1]);
  const auto middle = depth.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(depth.begin(), middle, depth.begin() + static_cast<std::ptrdiff_t>(count));
  return outermost > kGoesOn * *middle;
}

bool CandidateChecks::is_filled(const CeilingFrame& frame, const Candidate& candidate, int region_level) const {
  const bool bright = region_level > 0;
  const Raster& contrast = bright ? frame.reduced : frame.dark;
  const Outline& outline = candidate.hypothesis.outline;
  const PointTransform pose(candidate.fit.robot_from_outline);
  const double level = bright ? region_level : 0.5 * params_.unlit_contrast;
  int looked = 0;
  int filled = 0;
  for (int i = 0; i < 15; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vector2d place(outline.length * ((i + 0.5) / 15.0 - 0.5) * 0.9, outline.width * (j - 1) * 0.3);
      const auto pixel = camera_.pixel_of_ceiling_point(pose * place, outline.height);
      if (!pixel || !camera_.is_in_image(*pixel, frame.factor)) {
        continue;
      }
      ++looked;
      filled += cell_at(contrast, *pixel, frame.factor) > level ? 1 : 0;
    }
  }
  return looked >= 5 && filled * 100 >= looked * (bright ? 90 : 75);
}

}  // namespace luminav
