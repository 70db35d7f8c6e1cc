#include "services/detector/hypotheses/outline_proposer.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

using Eigen::Vector2d;
using Orientation = RegionShape::Orientation;
using Extents = RegionShape::Extents;

constexpr double kMinDepth = 0.3;       // of its width, of a fixture of which one long side is out of view
constexpr double kMinWidth = 0.55;      // of a lamp: its light may fade towards its sides
constexpr double kTube = 0.026;         // [m] T8
constexpr double kMaxWidth = 1.9;       // of a narrow one: blur and bloom
constexpr double kMinFillOfPart = 0.5;  // of the rectangle of a piece, whose corner may be cut off, or of a ragged one
constexpr double kOfNarrow = 0.25;      // of the tolerance: grooves look like narrow lamps, seldom of their length
constexpr double kMinFill = 0.68;       // of a region's rectangle, or of a disc's

struct Range {
  double min;
  double max;

  [[nodiscard]] bool holds(double value) const { return value >= min && value <= max; }
};

/// How wide a thing of that width may look. Of a lamp of several tubes the outermost may be all that shines.
Range widths_of(double width, int tubes, double cell, const SizeTolerance& tolerance) {
  const double slack = tolerance.share * width + std::max(tolerance.ragged, 1.5 * cell);
  if (tolerance.bloom <= 0.0) {
    return {width - slack, width + slack};
  }
  const double least = std::max(kMinWidth * width, (1.0 - 1.0 / std::max(tubes, 1)) * width + kTube);
  return {std::min(least, width - slack), std::max(kMaxWidth * width, width + slack + 2.0 * tolerance.bloom)};
}

}  // namespace

OutlineHypothesis& OutlineProposer::add(const Target& target, const Orientation& orientation, double along,
                                        double across) {
  const Vector2d on_reference = along * orientation.along + across * orientation.across();
  const Vector2d centre = plane_->camera_foot() + target.scale * (on_reference - plane_->camera_foot());
  const CeilingKind& kind = *target.kind;
  hypotheses_.push_back({.kind = target.index,
                         .burning = target.burning,
                         .outline = {target.burning > 0 ? FixtureShape::kRectangle : kind.shape, kind.length,
                                     target.width(), kind.height},
                         .start = {.pose = {centre.x(), centre.y(), wrap_axis(orientation.theta)}}});
  return hypotheses_.back();
}

void OutlineProposer::propose_whole(const Target& target, const RegionShape& shape, const Orientation& orientation,
                                    const SizeTolerance& tolerance) {
  const CeilingKind& kind = *target.kind;
  const Extents& e = orientation.extents;
  const double seen_length = target.scale * e.length();
  const double seen_width = target.scale * e.width();
  const double cell = target.scale * shape.cell_size();
  const double bloom = std::max(0.0, seen_width - target.width());  // it makes things as much longer as wider
  const double longer = tolerance.bloom > 0.0 ? seen_length - kind.length - bloom : seen_length - kind.length;
  const double slack = tolerance.share * kind.length + std::max(tolerance.ragged, 1.5 * cell);
  if (std::abs(longer) > slack || !widths_of(target.width(), target.tubes(), cell, tolerance).holds(seen_width)) {
    return;
  }
  const bool round = kind.shape == FixtureShape::kRound;
  const double of_rectangle = round ? 0.25 * kPi : 1.0;
  const double fill = target.scale * target.scale * shape.area() / (seen_length * seen_width * of_rectangle);
  const double min_fill = shape.touches_border() || tolerance.is_bare ? kMinFillOfPart : kMinFill;
  if (fill < min_fill * (1.0 - cell / seen_width)) {  // of what is a few cells wide, the ragged rim is much
    return;
  }
  OutlineHypothesis& hypothesis = add(target, orientation, e.middle_along(), e.middle_across());
  hypothesis.is_whole = !shape.touches_border();
  hypothesis.size_error = std::max(0.0, std::abs(longer) - 1.5 * cell) / kind.length;  // cells are no finer
  hypothesis.fill = fill;
  hypothesis.start.side_outset = 0.5 * (seen_width - target.width());
  hypothesis.start.end_outset = 0.5 * (seen_length - kind.length);
}

void OutlineProposer::propose_cut(const Target& target, const RegionShape& shape, const Orientation& orientation,
                                  const SizeTolerance& tolerance) {
  const CeilingKind& kind = *target.kind;
  const Extents& e = orientation.extents;
  const double seen_length = target.scale * e.length();
  const double seen_width = target.scale * e.width();
  const double cell = target.scale * shape.cell_size();
  const double slack = tolerance.share * kind.length + tolerance.ragged + 2.0 * tolerance.bloom;
  if (seen_length < tolerance.min_visible * kind.length || seen_length > kind.length + slack ||
      !widths_of(target.width(), target.tubes(), cell, tolerance).holds(seen_width) ||
      shape.eroded_area() < kMinFillOfPart * e.length() * e.width()) {
    return;
  }
  const double half_length = 0.5 * kind.length / target.scale;
  const double outset = 0.5 * (seen_width - target.width());
  const double bloom = tolerance.bloom > 0.0 ? std::max(outset, 0.0) / target.scale : 0.0;
  const bool near_cut = shape.is_cut_off(-orientation.along);
  const bool far_cut = shape.is_cut_off(orientation.along);
  if (!near_cut) {
    add(target, orientation, e.min_along + bloom + half_length, e.middle_across()).start.side_outset = outset;
  }
  if (!far_cut) {
    add(target, orientation, e.max_along - bloom - half_length, e.middle_across()).start.side_outset = outset;
  }
  if (near_cut && far_cut) {
    add(target, orientation, e.middle_along(), e.middle_across()).start.side_outset = outset;
  }
}

void OutlineProposer::propose_from_one_side(const Target& target, const RegionShape& shape,
                                            const Orientation& orientation, const SizeTolerance& tolerance) {
  const CeilingKind& kind = *target.kind;
  const Extents& e = orientation.extents;
  const double seen_length = target.scale * e.length();
  const double seen_width = target.scale * e.width();
  const double most = tolerance.ragged + 2.0 * tolerance.bloom;
  if (seen_width < kMinDepth * kind.width || seen_width > kind.width + most ||
      seen_length < tolerance.min_visible * kind.length || seen_length > (1.0 + tolerance.share) * kind.length + most) {
    return;
  }
  const double half_bloom = 0.5 * tolerance.bloom;
  const double half_length = 0.5 * kind.length / target.scale;
  const double half_width = 0.5 * kind.width / target.scale;
  for (const double side : {1.0, -1.0}) {  // the one in view
    if (shape.is_cut_off(side * orientation.across()) || !shape.is_cut_off(-side * orientation.across())) {
      continue;
    }
    const double edge = side > 0.0 ? e.max_across : e.min_across;
    const double across = edge - side * (half_bloom + half_width);
    const bool near_cut = shape.is_cut_off(-orientation.along);
    const bool far_cut = shape.is_cut_off(orientation.along);
    if (near_cut == far_cut) {
      add(target, orientation, e.middle_along(), across);
    } else {
      add(target, orientation,
          near_cut ? e.max_along - half_bloom - half_length : e.min_along + half_bloom + half_length, across);
    }
  }
}

void OutlineProposer::propose_beside_glow(const Target& target, const RegionShape& shape,
                                          const Orientation& orientation, const SizeTolerance& tolerance) {
  const CeilingKind& kind = *target.kind;
  const Extents& e = orientation.extents;
  const double longer = target.scale * e.length() - kind.length;
  const double seen_width = target.scale * e.width();
  if (std::abs(longer) > tolerance.share * kind.length || seen_width < kMaxWidth * kind.width ||
      seen_width > kMaxGlow * kind.length || shape.area() < kMinFill * e.length() * e.width()) {
    return;
  }
  const double half_width = 0.5 * kind.width / target.scale;
  for (const bool is_on_left : {true, false}) {
    const double across = is_on_left ? e.max_across - half_width : e.min_across + half_width;
    OutlineHypothesis& hypothesis = add(target, orientation, e.middle_along(), across);
    const bool is_turned = std::cos(hypothesis.start.pose.theta - orientation.theta) < 0.0;
    hypothesis.drowned = is_on_left == is_turned ? kLeftSide : kRightSide;
    hypothesis.size_error = std::abs(longer) / kind.length;
    hypothesis.start.end_outset = 0.5 * longer;
  }
}

void OutlineProposer::propose_kind(const Target& target, const RegionShape& shape, const SizeTolerance& tolerance,
                                   bool bright) {
  const bool bar = target.kind->shape == FixtureShape::kRectangle || target.burning > 0;
  const bool round = target.kind->shape == FixtureShape::kRound;
  const bool is_narrow = target.kind->width < tolerance.min_width;
  if (tolerance.is_bare ? round || target.kind->width > kMaxBare : is_narrow && (round || shape.touches_border())) {
    return;
  }
  SizeTolerance own = tolerance;
  own.share *= is_narrow ? kOfNarrow : 1.0;
  const std::vector<Orientation>& orientations = shape.orientations();
  for (std::size_t i = 0; i < orientations.size(); ++i) {
    if (bar || i % 2 == 0) {  // others look the same at right angles
      propose_whole(target, shape, orientations[i], own);
    }
    if (bar && shape.touches_border()) {
      propose_cut(target, shape, orientations[i], own);
    }
    if (bar && own.is_white && !shape.touches_border() && target.burning == 0) {
      propose_beside_glow(target, shape, orientations[i], own);
    }
    if (!round && shape.touches_border() && target.burning == 0) {
      propose_from_one_side(target, shape, orientations[i], own);
    }
  }
  if (bright && !round && target.burning == 0) {
    for (int burning = 1; burning < target.kind->lamps; ++burning) {
      propose_kind({target.kind, target.index, burning, target.scale}, shape, tolerance, bright);
    }
  }
}

const std::vector<OutlineHypothesis>& OutlineProposer::propose(const RegionShape& shape, bool bright,
                                                               const SizeTolerance& tolerance) {
  hypotheses_.clear();
  const double reference = plane_->ceiling_height() - plane_->camera_height();
  for (std::size_t i = 0; i < catalogue_->fixtures.size(); ++i) {
    const CeilingKind& kind = catalogue_->fixtures[i];
    const double scale = (kind.height - plane_->camera_height()) / reference;
    propose_kind({&kind, static_cast<int>(i), 0, scale}, shape, tolerance, bright);
  }
  const auto is_before = [](const OutlineHypothesis& a, const OutlineHypothesis& b) {
    return std::pair(!a.is_whole, a.size_error) < std::pair(!b.is_whole, b.size_error);
  };
  for (auto next = hypotheses_.begin(); next != hypotheses_.end(); ++next) {  // std::stable_sort takes memory
    std::rotate(std::upper_bound(hypotheses_.begin(), next, *next, is_before), next, next + 1);
  }
  return hypotheses_;
}

}  // namespace luminav
