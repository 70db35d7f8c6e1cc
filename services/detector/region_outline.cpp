#include "services/detector/region_outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace luminav {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

std::int64_t cross(const Vector2i& o, const Vector2i& a, const Vector2i& b) {
  return static_cast<std::int64_t>(a.x() - o.x()) * (b.y() - o.y()) -
         static_cast<std::int64_t>(a.y() - o.y()) * (b.x() - o.x());
}

/// Andrew's monotone chain; the points come sorted by row, then column.
void convex_hull(const std::vector<Vector2i>& points, std::vector<Vector2i>& hull) {
  hull.clear();
  const auto extend = [&](const Vector2i& point, std::size_t keep) {
    while (hull.size() >= keep + 2 && cross(hull[hull.size() - 2], hull.back(), point) <= 0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const Vector2i& point : points) {
    extend(point, 0);
  }
  const std::size_t lower = hull.size() - 1;
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) {
    extend(*point, lower);
  }
  if (hull.size() > 1) {
    hull.pop_back();
  }
}

// Of a fixture of which one long side is out of view: less leaves open what it is a piece of.
constexpr double kLeastDepth = 0.3;    // of its width
constexpr double kLeastStretch = 0.4;  // of its length
constexpr double kLeastEdge = 0.4;     // of a fixture's length, of a hull's edge that may be its long side
constexpr std::size_t kLongestEdges = 2;

bool fits(double seen, double side, const SizeTolerance& tolerance) {
  const double slack = tolerance.absolute + tolerance.share * side;
  return seen > side - slack && seen < side + slack + tolerance.bloom;
}

}  // namespace

CellPlane::CellPlane(const CeilingCamera& camera, int factor, double height)
    : width_(camera.intrinsics().width / factor),
      height_(camera.intrinsics().height / factor),
      ceiling_height_(height),
      camera_foot_(camera.mounting().x, camera.mounting().y),
      camera_height_(camera.mounting().z) {
  points_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  const double farthest = kFarthest * (height - camera_height_);
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const Vector2d pixel(factor * (column + 0.5) - 0.5, factor * (row + 0.5) - 0.5);
      const auto point = camera.point_on_ceiling(pixel, height);
      const bool near = point && (*point - camera_foot_).norm() < farthest;
      points_.emplace_back(near ? point->cast<float>() : Eigen::Vector2f(nothing, nothing));
    }
  }
}

Vector2d CellPlane::at(int column, int row) const {
  return points_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)]
      .cast<double>();
}

double CellPlane::cell_size(int column, int row) const {
  const int x = std::clamp(column, 0, width_ - 2);
  const int y = std::clamp(row, 0, height_ - 2);
  const Vector2d here = at(x, y);
  return std::max((at(x + 1, y) - here).norm(), (at(x, y + 1) - here).norm());
}

bool OutlineProposer::take_hull(const Region& region) {
  points_.clear();
  for (const Run& run : region.runs) {
    points_.emplace_back(run.first, run.row);
    if (run.last != run.first) {
      points_.emplace_back(run.last, run.row);
    }
  }
  if (points_.size() < 3) {
    return false;
  }
  convex_hull(points_, hull_);
  corners_.clear();
  touches_border_ = false;
  for (const Vector2i& cell : hull_) {
    const bool at_border =
        cell.x() <= 0 || cell.y() <= 0 || cell.x() >= plane_->width() - 1 || cell.y() >= plane_->height() - 1;
    const Vector2d place = plane_->at(cell.x(), cell.y());
    if (!place.allFinite()) {
      return false;
    }
    corners_.push_back({place, at_border});
    touches_border_ = touches_border_ || at_border;
  }
  return corners_.size() >= 3;
}

OutlineProposer::Way OutlineProposer::way_at(double theta) const {
  const Vector2d along(std::cos(theta), std::sin(theta));
  return {theta, along, extents(along)};
}

OutlineProposer::Extents OutlineProposer::extents(const Vector2d& along) const {
  const Vector2d across(-along.y(), along.x());
  Extents e{1e9, -1e9, 1e9, -1e9};
  for (const Corner& corner : corners_) {
    const double u = along.dot(corner.place);
    const double v = across.dot(corner.place);
    e.least_along = std::min(e.least_along, u);
    e.most_along = std::max(e.most_along, u);
    e.least_across = std::min(e.least_across, v);
    e.most_across = std::max(e.most_across, v);
  }
  return {e.least_along - grow_, e.most_along + grow_, e.least_across - grow_, e.most_across + grow_};
}

/// The direction of the smallest rectangle round the hull, and those of its longest edges that are the region's own.
void OutlineProposer::choose_directions() {
  directions_.clear();
  edges_.clear();
  double smallest = 1e18;
  std::size_t side_of_smallest = 0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Corner& a = corners_[i];
    const Corner& b = corners_[(i + 1) % corners_.size()];
    const Vector2d edge = b.place - a.place;
    const double length = edge.norm();
    edges_.push_back({length, !(a.at_border && b.at_border), a.place, b.place});
    const Extents e = extents(edge / length);
    const double area = (e.most_along - e.least_along) * (e.most_across - e.least_across);
    if (area < smallest) {
      smallest = area;
      side_of_smallest = i;
    }
  }
  const auto add = [&](double theta) {
    constexpr double kDistinct = radians(2.0);
    for (const double known : directions_) {
      if (std::abs(wrap_modulo(theta - known, 0.5 * kPi)) < kDistinct) {
        return;
      }
    }
    directions_.push_back(theta);
  };
  add(edges_[side_of_smallest].theta());
  std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.length > b.length; });
  if (touches_border_) {
    for (const Edge& edge : edges_) {
      if (edge.own && directions_.size() < 4) {
        add(edge.theta());
      }
    }
  }
}

void OutlineProposer::add(const CeilingKind& kind, const Placing& placing, const Way& way, double along,
                          double across) {
  const Vector2d on_reference = along * way.along + across * way.across();
  const Vector2d centre = plane_->camera_foot() + placing.scale * (on_reference - plane_->camera_foot());
  hypotheses_.push_back({.kind = placing.index,
                         .is_element = !kind.is_fixture,
                         .half_width = placing.half_width,
                         .outline = {kind.shape, kind.length, placing.width, kind.height},
                         .start = {centre.x(), centre.y(), wrap_axis(way.theta)},
                         .swelling = placing.swelling,
                         .uneven = placing.uneven});
}

void OutlineProposer::propose_kind(const CeilingKind& kind, int index, bool half_width, bool bright, const Way& way,
                                   const SizeTolerance& tolerance) {
  const double width = half_width ? 0.5 * kind.width : kind.width;
  const double scale = (kind.height - plane_->camera_height()) / (plane_->ceiling_height() - plane_->camera_height());
  const Extents& e = way.extents;
  const double seen_length = scale * (e.most_along - e.least_along);
  const double seen_width = scale * (e.most_across - e.least_across);
  if (!fits(seen_width, width, tolerance)) {
    return;
  }
  const bool whole = fits(seen_length, kind.length, tolerance);
  // Noise and joints may break the region of an unlit fixture.
  const bool may_be_part = touches_border_ || !bright;
  const bool cut = may_be_part && kind.is_fixture && kind.shape == FixtureShape::kRectangle &&
                   seen_length < kind.length + tolerance.absolute + tolerance.bloom &&
                   seen_length > tolerance.least_visible * kind.length;
  if (!whole && !cut) {
    return;
  }
  Placing placing{scale, width, index, half_width, 0.5 * (seen_width - width)};
  const double middle_across = 0.5 * (e.least_across + e.most_across);
  const double half_length = 0.5 * kind.length / scale;
  if (whole) {
    placing.uneven = std::abs((seen_length - kind.length) - (seen_width - width));
    add(kind, placing, way, 0.5 * (e.least_along + e.most_along), middle_across);
  }
  placing.uneven = 0.0;
  if (cut) {
    const double half_bloom = 0.25 * tolerance.bloom;
    add(kind, placing, way, e.least_along + half_bloom + half_length, middle_across);
    add(kind, placing, way, e.most_along - half_bloom - half_length, middle_across);
    if (!whole && touches_border_) {
      add(kind, placing, way, 0.5 * (e.least_along + e.most_along), middle_across);
    }
  }
}

bool OutlineProposer::is_cut_off(const Vector2d& direction) const {
  double farthest = -1e9;
  for (const Corner& corner : corners_) {
    farthest = std::max(farthest, direction.dot(corner.place));
  }
  return std::all_of(corners_.begin(), corners_.end(), [&](const Corner& corner) {
    return corner.at_border || direction.dot(corner.place) < farthest - 2.0 * grow_;
  });
}

void OutlineProposer::propose_from_one_side(const CeilingKind& kind, int index, const Way& way,
                                            const SizeTolerance& tolerance) {
  const double scale = (kind.height - plane_->camera_height()) / (plane_->ceiling_height() - plane_->camera_height());
  const Extents& e = way.extents;
  const double seen_length = scale * (e.most_along - e.least_along);
  const double seen_width = scale * (e.most_across - e.least_across);
  const double most = tolerance.absolute + tolerance.bloom;
  if (seen_width < kLeastDepth * kind.width || seen_width > kind.width + most ||
      seen_length < kLeastStretch * kind.length || seen_length > kind.length + tolerance.share * kind.length + most) {
    return;
  }
  const Placing placing{scale, kind.width, index, false, 0.0};
  const double half_bloom = 0.25 * tolerance.bloom;
  const double half_length = 0.5 * kind.length / scale;
  const double half_width = 0.5 * kind.width / scale;
  const Vector2d across = way.across();
  for (const double side : {1.0, -1.0}) {  // the one in view
    if (is_cut_off(side * across) || !is_cut_off(-side * across)) {
      continue;
    }
    const double edge = side > 0.0 ? e.most_across : e.least_across;
    const double middle_across = edge - side * (half_bloom + half_width);
    if (fits(seen_length, kind.length, tolerance)) {
      add(kind, placing, way, 0.5 * (e.least_along + e.most_along), middle_across);
    } else {
      add(kind, placing, way, e.least_along + half_bloom + half_length, middle_across);
      add(kind, placing, way, e.most_along - half_bloom - half_length, middle_across);
    }
  }
}

void OutlineProposer::propose_from_an_edge(const CeilingKind& kind, int index, const Edge& edge,
                                           const SizeTolerance& tolerance) {
  const double scale = (kind.height - plane_->camera_height()) / (plane_->ceiling_height() - plane_->camera_height());
  const Way way = way_at(edge.theta());
  const Extents& e = way.extents;
  const double seen_width = scale * (e.most_across - e.least_across);
  const double seen_length = scale * edge.length + 2.0 * grow_;
  if (seen_width < kind.width || fits(seen_width, kind.width, tolerance) || seen_length < kLeastEdge * kind.length ||
      seen_length > kind.length + tolerance.absolute + tolerance.bloom) {
    return;
  }
  const double line = way.across().dot(edge.start);
  const bool is_least = line - e.least_across < e.most_across - line;
  const double outline_edge = is_least ? e.least_across : e.most_across;
  const double middle_across = outline_edge + (is_least ? 0.5 : -0.5) * kind.width / scale;
  const Placing placing{scale, kind.width, index, false, 0.0};
  const double half_length = 0.5 * kind.length / scale;
  const double from = way.along.dot(edge.start) - grow_;
  const double to = way.along.dot(edge.end) + grow_;
  const std::size_t others = hypotheses_.size();
  if (fits(scale * (e.most_along - e.least_along), kind.length, tolerance)) {
    add(kind, placing, way, 0.5 * (e.least_along + e.most_along), middle_across);
  }
  add(kind, placing, way, from + half_length, middle_across);
  add(kind, placing, way, to - half_length, middle_across);
  for (std::size_t i = others; i < hypotheses_.size(); ++i) {
    hypotheses_[i].from_edge = true;
  }
}

void OutlineProposer::put_in_order() {
  const auto is_before = [](const OutlineHypothesis& a, const OutlineHypothesis& b) { return a.uneven < b.uneven; };
  for (auto next = hypotheses_.begin(); next != hypotheses_.end(); ++next) {  // std::stable_sort takes memory
    std::rotate(std::upper_bound(hypotheses_.begin(), next, *next, is_before), next, next + 1);
  }
}

const std::vector<OutlineHypothesis>& OutlineProposer::propose(const Region& region, int shrunk, bool bright,
                                                               const SizeTolerance& tolerance) {
  hypotheses_.clear();
  if (!take_hull(region)) {
    return hypotheses_;
  }
  grow_ = (0.5 + shrunk) * plane_->cell_size((region.left + region.right) / 2, (region.top + region.bottom) / 2);
  choose_directions();
  ways_.clear();
  for (const double theta : directions_) {
    ways_.push_back(way_at(theta));
    ways_.push_back(way_at(theta + 0.5 * kPi));
  }
  for (std::size_t i = 0; i < catalogue_->fixtures.size(); ++i) {
    const CeilingKind& kind = catalogue_->fixtures[i];
    // The others look the same at right angles.
    const std::size_t step = kind.shape == FixtureShape::kRectangle ? 1 : 2;
    for (std::size_t w = 0; w < ways_.size(); w += step) {
      propose_kind(kind, static_cast<int>(i), false, bright, ways_[w], tolerance);
      if (bright && kind.shape == FixtureShape::kRectangle && kind.lamps >= 2) {
        propose_kind(kind, static_cast<int>(i), true, bright, ways_[w], tolerance);
      }
      if (touches_border_ && kind.shape != FixtureShape::kRound) {
        propose_from_one_side(kind, static_cast<int>(i), ways_[w], tolerance);
      }
    }
  }
  if (bright && !touches_border_) {
    put_in_order();
  }
  if (!bright) {
    for (std::size_t i = 0; i < catalogue_->elements.size(); ++i) {
      for (const Way& way : std::span(ways_).first(2)) {
        propose_kind(catalogue_->elements[i], static_cast<int>(i), false, false, way, tolerance);
      }
    }
    for (std::size_t i = 0; i < catalogue_->fixtures.size(); ++i) {
      for (std::size_t k = 0; k < std::min(edges_.size(), kLongestEdges); ++k) {
        if (catalogue_->fixtures[i].shape == FixtureShape::kRectangle && edges_[k].own) {
          propose_from_an_edge(catalogue_->fixtures[i], static_cast<int>(i), edges_[k], tolerance);
        }
      }
    }
  }
  return hypotheses_;
}

}  // namespace luminav
