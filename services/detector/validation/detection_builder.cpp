#include "services/detector/validation/detection_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/detector/validation/half_lit.hpp"

namespace luminav {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

constexpr double kSoftMiddle = 0.007;  // [m] 1 sigma of where the burning half ends in the middle of its fixture
// 1 sigma, of the distance between the centres of a single lamp and of a half-lit fixture, when it may be either
constexpr double kOpenReading = 0.5;
constexpr double kOpenPlace = 0.1;    // variance along of a piece without ends, of the length out of view squared
constexpr double kSameLength = 0.05;  // [m]
constexpr double kSameWidth = 0.03;   // [m]

Matrix3d turned(const Matrix3d& covariance, double theta) {
  Matrix3d rotation = Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() << std::cos(theta), -std::sin(theta), std::sin(theta), std::cos(theta);
  return rotation * covariance * rotation.transpose();
}

/// On which side of a lit strip the dark lamps of its fixture lie, `dark_width` [m] of it: 1 on the left, -1 on the
/// right, 0 where it is a fixture of its own; nothing when it may be either. A dark half that is as bright as the
/// ceiling covers the ceiling's grid; one that is not shows by itself, and its louvre looks like a grid.
std::optional<int> dark_side_of(const CeilingFrame& frame, const CeilingCamera& camera, const Candidate& strip,
                                double dark_width) {
  const Outline& outline = strip.hypothesis.outline;
  const OutlinePlacement& placement = strip.fit.placement;
  const auto darker = find_darker_side(frame.image, camera, outline, placement, dark_width, frame.pixel_noise);
  if (darker.value_or(0) != 0) {
    return darker;
  }
  if (std::abs(dark_width - outline.width) > kSameWidth) {
    return std::nullopt;
  }
  const int covered = find_covered_side(frame.image, camera, outline, placement, frame.pixel_noise);
  return covered != 0 ? covered : darker;
}

}  // namespace

std::optional<Detection> DetectionBuilder::build(const CeilingFrame& frame, const Candidate& candidate) const {
  if (!candidate.bright) {
    return detection_of(candidate, DetectionState::kUnlit);
  }
  if (candidate.hypothesis.outline.shape == FixtureShape::kRectangle) {
    return resolve_strip(frame, candidate);
  }
  return ends_at_dark_lamps(frame, candidate) ? std::nullopt
                                              : std::optional(detection_of(candidate, DetectionState::kLit));
}

/// Light widens what burns: a piece as wide as one kind may be of a narrower one.
DetectionBuilder::Extent DetectionBuilder::lengths_of(const Candidate& candidate, double seen) const {
  const Outline& outline = candidate.hypothesis.outline;
  const double width = outline.width + 2.0 * candidate.fit.placement.side_outset;
  const double bloom = candidate.bright ? 2.0 * max_bloom_ : 0.0;
  Extent lengths{outline.length, outline.length};
  for (const CeilingKind& kind : catalogue_.fixtures) {
    if (kind.shape == FixtureShape::kRectangle && kind.length > seen - kSameLength && kind.width < width + kSameWidth &&
        kind.width > width - bloom - kSameWidth) {
      lengths.from = std::min(lengths.from, kind.length);
      lengths.to = std::max(lengths.to, kind.length);
    }
  }
  return lengths;
}

/// Only a stretch is seen: the centre lies anywhere within what is left of the length.
void DetectionBuilder::place_stretch(const Candidate& candidate, double length, Extent& extent, Detection& detection) {
  const double middle = 0.5 * (extent.from + extent.to);
  detection.robot_from_fixture = detection.robot_from_fixture * Pose2{middle, 0.0, 0.0};
  Matrix3d shift = Matrix3d::Identity();
  shift(1, 2) = middle;
  detection.covariance = shift * detection.covariance * shift.transpose();
  detection.covariance.row(0).setZero();
  detection.covariance.col(0).setZero();
  const double hidden = length - (extent.to - extent.from) + 2.0 * std::max(0.0, candidate.fit.placement.side_outset);
  detection.covariance(0, 0) = kOpenPlace * std::pow(std::max(0.0, hidden), 2) + 1e-4;
  extent = {extent.from - middle, extent.to - middle};
}

void DetectionBuilder::draw_corners(const Candidate& candidate, const Extent& extent, Detection& detection) const {
  const double height = candidate.hypothesis.outline.height;
  const double half_width = 0.5 * candidate.hypothesis.outline.width;
  const PointTransform pose(detection.robot_from_fixture);
  const std::array<Vector2d, 4> corners{Vector2d(extent.to, half_width), Vector2d(extent.from, half_width),
                                        Vector2d(extent.from, -half_width), Vector2d(extent.to, -half_width)};
  detection.clipped = !detection.far_end_visible || !detection.near_end_visible;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera_.pixel_of_ceiling_point(pose * corners[i], height);
    detection.corners_px[i] = pixel.value_or(Vector2d(-1.0, -1.0));
    detection.clipped = detection.clipped || !pixel || !camera_.is_in_image(*pixel);
  }
  detection.centre_px =
      camera_.pixel_of_ceiling_point(detection.robot_from_fixture.position(), height).value_or(Vector2d(-1.0, -1.0));
}

Detection DetectionBuilder::detection_of(const Candidate& candidate, DetectionState state) const {
  const Outline& outline = candidate.hypothesis.outline;
  const OutlineFit& fit = candidate.fit;
  const bool bar = outline.shape == FixtureShape::kRectangle && candidate.by_edges;
  Detection detection;
  detection.shape = outline.shape;
  detection.state = state;
  detection.has_theta = outline.shape != FixtureShape::kRound;
  detection.fit = fit.quality();
  detection.robot_from_fixture = fit.placement.pose;
  detection.covariance = fit.covariance;
  detection.far_end_visible = !bar || fit.end_visible(kFarEnd);
  detection.near_end_visible = !bar || fit.end_visible(kNearEnd);
  Extent extent{detection.near_end_visible ? -0.5 * outline.length : fit.visible_from,
                detection.far_end_visible ? 0.5 * outline.length : fit.visible_to};
  const Extent lengths = lengths_of(candidate, extent.to - extent.from);
  if (detection.far_end_visible != detection.near_end_visible) {
    // an end may bloom less than a side, or twice as much, and does not cancel the other's
    detection.covariance(0, 0) += std::pow(fit.placement.side_outset, 2);
    if (lengths.to - lengths.from > kSameLength) {  // nobody knows how far from the end the centre lies
      detection.far_end_visible = detection.near_end_visible = false;
    }
  }
  if (!detection.far_end_visible && !detection.near_end_visible) {
    place_stretch(candidate, lengths.to, extent, detection);
  }
  if (outline.shape == FixtureShape::kRound) {
    detection.covariance.row(2).setZero();
    detection.covariance.col(2).setZero();
    detection.covariance(2, 2) = kPi * kPi / 3.0;
  }
  detection.covariance = turned(detection.covariance, detection.robot_from_fixture.theta);
  const double theta = detection.robot_from_fixture.theta;
  detection.robot_from_fixture.theta = wrap_modulo(theta, symmetry_period(outline.shape));
  if (std::abs(wrap_angle(detection.robot_from_fixture.theta - theta)) > 0.75 * kPi) {  // the ends change places
    std::swap(detection.far_end_visible, detection.near_end_visible);
    extent = {-extent.to, -extent.from};
  }
  detection.length = extent.to - extent.from;
  detection.width = outline.width + 2.0 * fit.placement.side_outset;
  draw_corners(candidate, extent, detection);
  if (bar && outline.length > 1.5 * outline.width && candidate.is_whole()) {
    // Bloom moves sides and ends alike; another scale moves the ends farther.
    const OutlinePlacement& seen = fit.placement;
    detection.scale =
        1.0 + 2.0 * (candidate.bright ? (seen.end_outset - seen.side_outset) / (outline.length - outline.width)
                                      : seen.end_outset / outline.length);
  }
  return detection;
}

const CeilingKind* DetectionBuilder::kind_of(const Outline& outline) const {
  const auto found = std::find_if(catalogue_.fixtures.begin(), catalogue_.fixtures.end(), [&](const CeilingKind& kind) {
    return kind.shape == FixtureShape::kRectangle && std::abs(kind.length - outline.length) <= kSameLength &&
           std::abs(kind.width - outline.width) < kSameWidth;
  });
  return found == catalogue_.fixtures.end() ? nullptr : &*found;
}

/// True when a side of it is where the burning lamps of a larger fixture end: what the border cuts may be these alone.
bool DetectionBuilder::ends_at_dark_lamps(const CeilingFrame& frame, const Candidate& square) const {
  const CeilingKind& kind = catalogue_.fixtures[static_cast<std::size_t>(square.hypothesis.kind)];
  for (int dark = 1; dark < kind.lamps; ++dark) {
    if (find_darker_side(frame.image, camera_, square.hypothesis.outline, square.fit.placement,
                         kind.width * dark / kind.lamps, frame.pixel_noise)
            .value_or(0) != 0) {
      return true;
    }
  }
  return false;
}

/// A fixture of several lamps of which some may burn alone and look like this.
const CeilingKind* DetectionBuilder::kind_of_part(const OutlineHypothesis& strip) const {
  if (strip.burning > 0) {
    return &catalogue_.fixtures[static_cast<std::size_t>(strip.kind)];
  }
  const Outline& outline = strip.outline;
  const auto found = std::find_if(catalogue_.fixtures.begin(), catalogue_.fixtures.end(), [&](const CeilingKind& kind) {
    return kind.shape == FixtureShape::kRectangle && kind.lamps >= 2 &&
           std::abs(kind.length - outline.length) <= kSameLength &&
           std::abs(kind.width - outline.width) >= kSameWidth &&
           std::abs(0.5 * kind.width - outline.width) < kSameWidth;
  });
  return found == catalogue_.fixtures.end() ? nullptr : &*found;
}

std::optional<Detection> DetectionBuilder::resolve_strip(const CeilingFrame& frame, const Candidate& strip) const {
  const double width = strip.hypothesis.outline.width;
  const CeilingKind* single = kind_of(strip.hypothesis.outline);
  const CeilingKind* fixture_kind = kind_of_part(strip.hypothesis);
  if (fixture_kind == nullptr) {
    return single == nullptr ? std::nullopt : std::optional(detection_of(strip, DetectionState::kLit));
  }
  const std::optional<int> dark_side = dark_side_of(frame, camera_, strip, fixture_kind->width - width);
  if (dark_side.value_or(0) != 0) {
    if (fixture_kind->shape == FixtureShape::kSquare && strip.fit.ends_visible() < 2) {
      return std::nullopt;
    }
    Candidate fixture = strip;
    fixture.hypothesis.outline = {fixture_kind->shape, fixture_kind->length, fixture_kind->width, fixture_kind->height};
    fixture.fit.placement.pose =
        strip.fit.placement.pose * Pose2{0.0, 0.5 * *dark_side * (fixture_kind->width - width), 0.0};
    fixture.fit.covariance(1, 1) += kSoftMiddle * kSoftMiddle;
    return detection_of(fixture, DetectionState::kHalf);
  }
  if (single == nullptr) {
    return std::nullopt;
  }
  Candidate lamp = strip;
  if (!dark_side) {
    lamp.fit.covariance(1, 1) += std::pow(kOpenReading * 0.5 * (fixture_kind->width - width), 2);
  }
  return detection_of(lamp, DetectionState::kLit);
}

}  // namespace luminav
