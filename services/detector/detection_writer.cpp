#include "services/detector/detection_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/detector/crossing_joints.hpp"
#include "services/detector/strip_surroundings.hpp"

namespace luminav {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

// Asymmetry of a strip with its like on both sides: 0 to 0.23; of a burning half: 0.45 to 0.6 (simulated pictures).
constexpr double kSignOfHalf = 0.33;
constexpr double kClearlyHalf = 0.45;
constexpr double kShort = 0.45;        // of the length: over that a dark half may be as bright as the ceiling
constexpr double kSoftMiddle = 0.007;  // [m] 1 sigma of where the burning half ends in the middle of its fixture
// 1 sigma, of the distance between the centres of a single lamp and of a half-lit fixture, when it may be either.
constexpr double kOpenReading = 0.5;
// Variance along of a piece without ends, of the length out of view squared: 1/12 if all places were alike, but an end
// that the border leaves a corner of is commoner (1.2/12 measured on simulated pictures).
constexpr double kOpenPlace = 0.1;
constexpr double kUnevenEnd =
    0.075;  // of the swelling, 1 sigma, by which that of an end differs from that of the sides

Matrix3d turned(const Matrix3d& covariance, double theta) {
  Matrix3d rotation = Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() << std::cos(theta), -std::sin(theta), std::sin(theta), std::cos(theta);
  return rotation * covariance * rotation.transpose();
}

/// What a lit strip of half the width of a fixture of two lamps may be: a fixture of one, a half of one of two, either,
/// or something else.
enum class StripReading { kWhole, kDarkOnLeft, kDarkOnRight, kWholeOrHalf, kUnclear };

/// Joints decide where there are any: a dark half may be as bright as the ceiling, but it covers them.
StripReading read_strip(const CeilingFrame& frame, const CeilingCamera& camera, const Candidate& strip) {
  const Outline& outline = strip.hypothesis.outline;
  const auto [left, right] = look_for_crossing_joints(frame.image, camera, outline, strip.fit.robot_from_outline,
                                                      strip.fit.swelling, frame.pixel_noise);
  if (left == Beside::kCeiling && right == Beside::kCeiling) {
    return StripReading::kWhole;
  }
  if ((left == Beside::kCovered) != (right == Beside::kCovered)) {
    return left == Beside::kCovered ? StripReading::kDarkOnLeft : StripReading::kDarkOnRight;
  }
  const StripSurroundings around = compare_strip_sides(frame.image, camera, outline, strip.fit, frame.pixel_noise);
  if (!around.valid) {
    return StripReading::kWholeOrHalf;
  }
  if (around.asymmetry > kClearlyHalf && around.side != 0) {
    if ((around.side > 0 ? left : right) == Beside::kCeiling) {
      return StripReading::kUnclear;
    }
    return around.side > 0 ? StripReading::kDarkOnLeft : StripReading::kDarkOnRight;
  }
  if (around.asymmetry <= kSignOfHalf) {
    return StripReading::kWhole;
  }
  return strip.fit.visible_to - strip.fit.visible_from < kShort * outline.length ? StripReading::kWholeOrHalf
                                                                                 : StripReading::kUnclear;
}

DetectionShape shape_of(const OutlineHypothesis& hypothesis) {
  if (hypothesis.is_element) {
    return DetectionShape::kElement;
  }
  switch (hypothesis.outline.shape) {
    case FixtureShape::kSquare:
      return DetectionShape::kSquare;
    case FixtureShape::kRound:
      return DetectionShape::kRound;
    case FixtureShape::kRectangle:
      break;
  }
  return DetectionShape::kRectangle;
}

}  // namespace

Detection DetectionWriter::detection_of(const Candidate& candidate, DetectionState state) const {
  const Outline& outline = candidate.hypothesis.outline;
  const OutlineFit& fit = candidate.fit;
  Detection detection;
  detection.shape = shape_of(candidate.hypothesis);
  detection.state = state;
  detection.has_theta = outline.shape != FixtureShape::kRound;
  detection.fit = fit.quality();
  detection.robot_from_fixture = fit.robot_from_outline;
  const double period = symmetry_period(outline.shape);
  Matrix3d covariance = fit.covariance;
  double width = outline.width;
  if (candidate.narrower) {
    width = candidate.narrower->width;
    covariance(1, 1) += candidate.narrower->share * std::pow(0.5 * (outline.width - width), 2);
  }

  const bool bar = outline.shape == FixtureShape::kRectangle;
  detection.far_end_visible = !bar || fit.end_visible(kFarEnd);
  detection.near_end_visible = !bar || fit.end_visible(kNearEnd);
  double seen_from = -0.5 * outline.length;
  double seen_to = 0.5 * outline.length;
  if (!detection.near_end_visible) {
    seen_from = fit.visible_from;
  }
  if (!detection.far_end_visible) {
    seen_to = fit.visible_to;
  }
  if (!detection.far_end_visible && !detection.near_end_visible) {
    // Only a stretch is seen: the centre lies anywhere within what is left of the length. Bloom shows edges beyond an
    // end.
    const double middle = 0.5 * (seen_from + seen_to);
    detection.robot_from_fixture = fit.robot_from_outline * Pose2{middle, 0.0, 0.0};
    Matrix3d shift = Matrix3d::Identity();
    shift(1, 2) = middle;
    covariance = shift * covariance * shift.transpose();
    covariance.row(0).setZero();
    covariance.col(0).setZero();
    const double free = std::max(0.0, outline.length - (seen_to - seen_from) + 2.0 * std::max(0.0, fit.swelling));
    covariance(0, 0) = kOpenPlace * free * free + 1e-4;
    seen_from -= middle;
    seen_to -= middle;
  } else if (detection.far_end_visible != detection.near_end_visible) {
    // One end: its bloom does not cancel, and other kinds of this width may be longer or shorter.
    covariance(0, 0) += std::pow(kUnevenEnd * fit.swelling, 2);
    double shortest = outline.length;
    double longest = outline.length;
    for (const CeilingKind& kind : catalogue_.fixtures) {
      if (!candidate.hypothesis.is_element && kind.shape == FixtureShape::kRectangle &&
          std::abs(kind.width - outline.width) < 0.02 && kind.length > seen_to - seen_from) {
        shortest = std::min(shortest, kind.length);
        longest = std::max(longest, kind.length);
      }
    }
    if (longest - shortest > 0.005) {
      const double inward = detection.far_end_visible ? -1.0 : 1.0;
      const double shift = 0.5 * inward * (0.5 * (shortest + longest) - outline.length);
      detection.robot_from_fixture = detection.robot_from_fixture * Pose2{shift, 0.0, 0.0};
      seen_from -= shift;
      seen_to -= shift;
      covariance(0, 0) += std::pow(0.25 * (longest - shortest), 2);
    }
  }
  if (outline.shape == FixtureShape::kRound) {
    covariance.row(2).setZero();
    covariance.col(2).setZero();
    covariance(2, 2) = kPi * kPi / 3.0;
  }
  detection.covariance = turned(covariance, detection.robot_from_fixture.theta);
  detection.robot_from_fixture.theta = wrap_modulo(detection.robot_from_fixture.theta, period);

  detection.length = seen_to - seen_from;
  detection.width = width + 2.0 * fit.swelling;
  const Pose2& pose = detection.robot_from_fixture;
  // after wrapping by a quarter or half turn the ends may have changed places
  const double turned_by = std::abs(wrap_angle(pose.theta - fit.robot_from_outline.theta));
  if (turned_by > 0.75 * kPi) {
    std::swap(detection.far_end_visible, detection.near_end_visible);
    const double from = seen_from;
    seen_from = -seen_to;
    seen_to = -from;
  }
  const double half_width = 0.5 * outline.width;
  const std::array<Vector2d, 4> corners{Vector2d(seen_to, half_width), Vector2d(seen_from, half_width),
                                        Vector2d(seen_from, -half_width), Vector2d(seen_to, -half_width)};
  detection.clipped = false;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera_.pixel_of_ceiling_point(pose * corners[i], outline.height);
    detection.corners_px[i] = pixel.value_or(Vector2d(-1.0, -1.0));
    detection.clipped = detection.clipped || !pixel || !camera_.is_in_image(*pixel);
  }
  detection.clipped = detection.clipped || !detection.far_end_visible || !detection.near_end_visible;
  detection.centre_px = camera_.pixel_of_ceiling_point(pose.position(), outline.height).value_or(Vector2d(-1.0, -1.0));
  return detection;
}

const CeilingKind* DetectionWriter::kind_of(const Outline& outline) const {
  const CeilingKind* found = nullptr;
  for (const CeilingKind& kind : catalogue_.fixtures) {
    if (kind.shape == FixtureShape::kRectangle && std::abs(kind.length - outline.length) <= 0.05 &&
        std::abs(kind.width - outline.width) < 0.03) {
      found = &kind;
    }
  }
  return found;
}

std::optional<Side> DetectionWriter::dark_half(const CeilingFrame& frame, const Candidate& candidate) const {
  constexpr double kDifference = 15.0;  // [grey] between the halves; two burning tubes both saturate
  constexpr double kAcross = 0.38;      // of the width from the middle: the burning half shines over it
  const Outline& outline = candidate.hypothesis.outline;
  const CeilingKind* kind = kind_of(outline);
  if (candidate.hypothesis.is_element || outline.shape != FixtureShape::kRectangle || kind == nullptr ||
      kind->lamps < 2) {
    return std::nullopt;
  }
  const PointTransform pose(candidate.fit.robot_from_outline);
  std::array<double, 2> sum{};
  std::array<int, 2> count{};
  for (int i = 0; i < 24; ++i) {
    for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
      const Vector2d place(0.9 * outline.length * ((i + 0.5) / 24.0 - 0.5),
                           outline.width * (half == 0 ? kAcross : -kAcross));
      const auto pixel = camera_.pixel_of_ceiling_point(pose * place, outline.height);
      if (pixel && camera_.is_in_image(*pixel, frame.factor)) {
        sum[half] += cell_at(frame.reduced, *pixel, frame.factor);
        ++count[half];
      }
    }
  }
  if (count[0] < 3 || count[1] < 3) {
    return std::nullopt;
  }
  const double difference = sum[0] / count[0] - sum[1] / count[1];
  return std::abs(difference) <= kDifference ? std::nullopt : std::optional(difference > 0.0 ? kRightSide : kLeftSide);
}

std::optional<Detection> DetectionWriter::resolve_strip(const CeilingFrame& frame, const Candidate& strip) const {
  const double width = strip.hypothesis.outline.width;
  const CeilingKind* single = kind_of(strip.hypothesis.outline);
  const CeilingKind* pair = nullptr;  // a fixture of two lamps of which this may be one
  for (const CeilingKind& kind : catalogue_.fixtures) {
    if (kind.shape != FixtureShape::kRectangle || std::abs(kind.length - strip.hypothesis.outline.length) > 0.05) {
      continue;
    }
    if (std::abs(kind.width - width) >= 0.03 && kind.lamps >= 2 && std::abs(0.5 * kind.width - width) < 0.03) {
      pair = &kind;
    }
  }
  if (dark_half(frame, strip)) {
    return detection_of(strip, DetectionState::kHalf);
  }
  if (pair == nullptr) {
    return single == nullptr ? std::nullopt : std::optional(detection_of(strip, DetectionState::kLit));
  }
  const StripReading reading = read_strip(frame, camera_, strip);
  const int dark_side = reading == StripReading::kDarkOnLeft ? 1 : reading == StripReading::kDarkOnRight ? -1 : 0;
  if (dark_side != 0) {
    Candidate fixture = strip;
    fixture.hypothesis.outline = {FixtureShape::kRectangle, pair->length, pair->width, pair->height};
    fixture.fit.robot_from_outline = strip.fit.robot_from_outline * Pose2{0.0, 0.5 * dark_side * width, 0.0};
    fixture.fit.covariance(1, 1) += kSoftMiddle * kSoftMiddle;
    return detection_of(fixture, DetectionState::kHalf);
  }
  if (single == nullptr || reading == StripReading::kUnclear) {
    return std::nullopt;
  }
  Candidate lamp = strip;
  if (reading == StripReading::kWholeOrHalf) {
    lamp.fit.covariance(1, 1) += std::pow(kOpenReading * 0.5 * width, 2);
  }
  return detection_of(lamp, DetectionState::kLit);
}

}  // namespace luminav
