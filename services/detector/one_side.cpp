#include "services/detector/one_side.hpp"

#include <algorithm>
#include <cmath>

#include "services/detector/surface_texture.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kSameSide = 0.06;   // [m] bloom and the fit's error, at most
constexpr double kSameWidth = 0.02;  // [m]
constexpr int kFarMore = 2;          // times as many
// [px] from the edge of a lamp its light is clearly less than its own. One side does not tell how far bloom moves its
// edge; both ends do: the burning half of a fixture then looks up to 1.5 px wider than it is (rendered frames).
constexpr double kBloomReach = 6.0;
constexpr double kKnownBloomReach = 3.0;
constexpr double kAsBright = 0.88;      // of the inside
constexpr double kAsDark = 0.5;         // of the depth inside
constexpr double kBlurredReach = 0.03;  // [m] from the edge of something dark, in cells of the reduced image
constexpr double kLeastStep = 30.0;     // [grey] of a lamp above the ceiling that it lights
// The same where no end is seen: daylight on the ceiling beside a window reaches 30, a lamp at least 107 (simulated
// pictures).
constexpr double kLeastStepWithoutEnds = 60.0;
// Depth 30 mm outside of the side and 110 mm inside, of that next to it inside: fixtures to 0.15 and 1.03, a head 0.44
// and 1.2 (simulated pictures).
constexpr double kSoftEdge = 0.28;
constexpr double kDeeperInside = 1.12;
constexpr int kPlaces = 32;  // along the side
constexpr int kLeastPlaces = 6;
constexpr int kStrayPlaces = 1;     // that count for nothing
constexpr double kFarther = 0.012;  // [m] from one row of places to the next

}  // namespace

std::optional<double> PieceFromOneSide::level_at(const Vector2d& place) const {
  const auto pixel = camera_.pixel_of_ceiling_point(PointTransform(candidate_.fit.robot_from_outline) * place,
                                                    candidate_.hypothesis.outline.height);
  if (!pixel || !camera_.is_in_image(*pixel)) {
    return std::nullopt;
  }
  return cell_at(bright_ ? frame_.reduced : frame_.dark, *pixel, frame_.factor);
}

std::optional<double> PieceFromOneSide::difference(Side side) const {
  const Outline& outline = candidate_.hypothesis.outline;
  const bool is_end = side == kFarEnd || side == kNearEnd;
  const double outwards = side == kLeftSide || side == kFarEnd ? 1.0 : -1.0;
  const double extent = is_end ? outline.width : outline.length;
  const double half = 0.5 * (is_end ? outline.length : outline.width);
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double along = 0.9 * extent * ((i + 0.5) / kPlaces - 0.5);
    for (const double distance : {0.035, 0.055}) {  // [m] beyond blur and joints
      const auto place = [&](double off) {
        const double out = outwards * (half + off);
        return is_end ? Vector2d(out, along) : Vector2d(along, out);
      };
      const auto inside = level_at(place(-distance));
      const auto outside = level_at(place(std::max(candidate_.fit.swelling, 0.0) + distance));
      if (inside && outside) {
        sum += *inside - *outside;
        ++count;
      }
    }
  }
  return count < kLeastPlaces ? std::nullopt : std::optional(sum / count);
}

double PieceFromOneSide::mean_level(double inwards) const {
  const Outline& outline = candidate_.hypothesis.outline;
  const double outwards = side_ == kLeftSide ? 1.0 : -1.0;
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double along = outline.length * ((i + 0.5) / kPlaces - 0.5);
    if (const auto level = level_at({along, outwards * (0.5 * outline.width - inwards)})) {
      sum += *level;
      ++count;
    }
  }
  return count == 0 ? 0.0 : sum / count;
}

bool PieceFromOneSide::is_evenly_dark() const {
  const double inside = 0.5 * (mean_level(0.03) + mean_level(0.045));
  return mean_level(-0.03) < kSoftEdge * inside && mean_level(0.11) < kDeeperInside * inside;
}

bool PieceFromOneSide::stands_out() const {
  const OutlineFit& fit = candidate_.fit;
  const bool any_end = fit.end_visible(kFarEnd) || fit.end_visible(kNearEnd);
  const double least = !bright_ ? kAsDark * fit.step : any_end ? kLeastStep : kLeastStepWithoutEnds;
  const auto is_clear = [&](Side side) {
    const auto step = difference(side);
    return step && *step > least;
  };
  if (!bright_ && !any_end && !is_evenly_dark()) {
    return false;
  }
  return is_clear(side_) && (!fit.end_visible(kFarEnd) || is_clear(kFarEnd)) &&
         (!fit.end_visible(kNearEnd) || is_clear(kNearEnd));
}

double PieceFromOneSide::blurred_reach() const {
  const OutlineFit& fit = candidate_.fit;
  const bool both_ends = fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd);
  const double bloom_px = both_ends ? kKnownBloomReach : kBloomReach;
  return bright_ ? std::max(fit.swelling, 0.0) + bloom_px * fit.metres_per_px : kBlurredReach;
}

PieceFromOneSide::Places PieceFromOneSide::look_at(double distance, double width) const {
  const Outline& outline = candidate_.hypothesis.outline;
  const double outwards = side_ == kLeftSide ? 1.0 : -1.0;
  Places places;
  for (int i = 0; i < kPlaces; ++i) {
    const double along = 0.92 * outline.length * ((i + 0.5) / kPlaces - 0.5);
    const auto inside = level_at({along, outwards * (0.5 * outline.width - 0.5 * width)});
    const auto there = level_at({along, outwards * (0.5 * outline.width - distance)});
    if (inside && there) {
      ++(*there > (bright_ ? kAsBright : kAsDark) * *inside ? places.like_inside : places.unlike);
    }
  }
  return places;
}

bool PieceFromOneSide::goes_on_beyond(double width) const {
  const double own_width = candidate_.hypothesis.outline.width;
  const Places nearest = look_at(width + blurred_reach(), width);
  const int looked = nearest.like_inside + nearest.unlike;
  if (looked < kLeastPlaces || 10 * nearest.like_inside < 9 * looked) {
    return false;
  }
  // A lamp is bright up to its other side. Where it is not, bloom moved the side in view, and it is a narrower one.
  for (double distance = width + blurred_reach(); bright_ && distance < own_width - blurred_reach();
       distance += kFarther) {
    if (look_at(distance, width).unlike > kStrayPlaces) {
      return false;
    }
  }
  return true;
}

bool PieceFromOneSide::may_be(double length, double width) const {
  const Outline& outline = candidate_.hypothesis.outline;
  const OutlineFit& fit = candidate_.fit;
  const bool same = std::abs(length - outline.length) < kSameSide && std::abs(width - outline.width) < kSameWidth;
  const bool too_short = fit.visible_to - fit.visible_from > length + kSameSide;
  const bool both_ends = fit.end_visible(kFarEnd) && fit.end_visible(kNearEnd);
  const bool other_length = both_ends && std::abs(length - outline.length) > kSameSide;
  return !same && !too_short && !other_length && !(width < outline.width - kSameWidth && goes_on_beyond(width));
}

bool PieceFromOneSide::is_rather(const CeilingKind& kind) const {
  return kind.shape != FixtureShape::kRound && (may_be(kind.length, kind.width) || may_be(kind.width, kind.length));
}

bool PieceFromOneSide::may_be_it_or_half_of(const CeilingKind& kind) const {
  return is_rather(kind) || (bright_ && kind.lamps >= 2 && may_be(kind.length, 0.5 * kind.width));
}

bool PieceFromOneSide::may_be_another(const CeilingCatalogue& catalogue) const {
  return std::any_of(catalogue.fixtures.begin(), catalogue.fixtures.end(),
                     [&](const CeilingKind& kind) { return may_be_it_or_half_of(kind); }) ||
         may_be_an_element(catalogue);
}

bool PieceFromOneSide::may_be_an_element(const CeilingCatalogue& catalogue) const {
  return std::any_of(catalogue.elements.begin(), catalogue.elements.end(), [&](const CeilingKind& kind) {
    return (kind.luminous || !bright_) && is_rather(kind) &&
           !(kind.slatted && is_surely_smooth(frame_.image, camera_, candidate_.hypothesis.outline, candidate_.fit,
                                              frame_.pixel_noise));
  });
}

std::optional<NarrowerReading> PieceFromOneSide::rare_narrower(const CeilingCatalogue& catalogue) const {
  const Outline& outline = candidate_.hypothesis.outline;
  int own = 0;
  int narrower = 0;
  double width = outline.width;
  for (const CeilingKind& kind : catalogue.fixtures) {
    const bool is_as_long =
        kind.shape == FixtureShape::kRectangle && std::abs(kind.length - outline.length) < kSameSide;
    if (is_as_long && std::abs(kind.width - outline.width) < kSameWidth) {
      own += kind.count;
    } else if (is_as_long && kind.width < outline.width && may_be(kind.length, kind.width)) {
      narrower += kind.count;
      width = std::min(width, kind.width);
    } else if (may_be_it_or_half_of(kind)) {
      return std::nullopt;
    }
  }
  if (own == 0 || own < kFarMore * narrower || may_be_an_element(catalogue)) {
    return std::nullopt;
  }
  return NarrowerReading{width, static_cast<double>(narrower) / (own + narrower)};
}

}  // namespace luminav
