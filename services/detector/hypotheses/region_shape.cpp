#include "services/detector/hypotheses/region_shape.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

constexpr std::size_t kMaxOrientations = 8;

int cross(const Vector2i& o, const Vector2i& a, const Vector2i& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

/// Andrew's monotone chain, of one side: what bends outwards (`turn` = 1 on the left) beyond the last two is left out.
void extend(std::vector<Vector2i>& chain, const Vector2i& point, int turn) {
  while (chain.size() >= 2 && turn * cross(chain[chain.size() - 2], chain.back(), point) >= 0) {
    chain.pop_back();
  }
  chain.push_back(point);
}

/// Of each row only the outermost cells may be corners of the hull: one chain down the left, one down the right.
void convex_hull(std::span<const Run> runs, std::vector<Vector2i>& hull, std::vector<Vector2i>& right) {
  hull.clear();
  right.clear();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (i == 0 || runs[i].row != runs[i - 1].row) {
      extend(hull, {runs[i].first, runs[i].row}, 1);
    }
    if (i + 1 == runs.size() || runs[i].row != runs[i + 1].row) {
      extend(right, {runs[i].last, runs[i].row}, -1);
    }
  }
  for (auto point = right.rbegin(); point != right.rend(); ++point) {
    if (*point != hull.back() && *point != hull.front()) {
      hull.push_back(*point);
    }
  }
}

}  // namespace

bool RegionShape::take(const Region& region, int shrunk, const CellPlane& plane) {
  convex_hull(region.runs, hull_, right_);
  corners_.clear();
  touches_border_ = false;
  for (const Vector2i& cell : hull_) {
    corners_.push_back({plane.at(cell.x(), cell.y()), plane.is_at_border(cell.x(), cell.y())});
    touches_border_ = touches_border_ || corners_.back().at_border;
    if (!corners_.back().place.allFinite()) {
      return false;
    }
  }
  if (corners_.size() < 3) {
    return false;
  }
  const auto [side, area] = plane.footprint((region.left + region.right) / 2, (region.top + region.bottom) / 2);
  cell_size_ = side;
  grow_ = (0.5 + shrunk) * cell_size_;
  eroded_area_ = region.cells * area;
  area_ = eroded_area_ + shrunk * cell_size_ * hull_length();
  choose_orientations();
  return area_ > 0.0;  // false of no number
}

double RegionShape::hull_length() const {
  double length = 0.0;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    length += (corners_[(i + 1) % corners_.size()].place - corners_[i].place).norm();
  }
  return length;
}

RegionShape::Extents RegionShape::extents(const Vector2d& along) const {
  const Vector2d across(-along.y(), along.x());
  Extents e{1e9, -1e9, 1e9, -1e9};
  for (const Corner& corner : corners_) {
    const double u = along.dot(corner.place);
    const double v = across.dot(corner.place);
    e.min_along = std::min(e.min_along, u);
    e.max_along = std::max(e.max_along, u);
    e.min_across = std::min(e.min_across, v);
    e.max_across = std::max(e.max_across, v);
  }
  return {e.min_along - grow_, e.max_along + grow_, e.min_across - grow_, e.max_across + grow_};
}

void RegionShape::add_orientation(const Vector2d& edge) {
  const double theta = std::atan2(edge.y(), edge.x());
  constexpr double kDistinct = radians(2.0);
  for (const Orientation& known : orientations_) {
    if (std::abs(wrap_modulo(theta - known.theta, 0.5 * kPi)) < kDistinct) {
      return;
    }
  }
  for (const double angle : {theta, theta + 0.5 * kPi}) {
    const Vector2d along(std::cos(angle), std::sin(angle));
    orientations_.push_back({angle, along, extents(along)});
  }
}

void RegionShape::choose_orientations() {
  orientations_.clear();
  edges_.clear();
  double smallest = 1e18;
  Vector2d along_smallest = Vector2d::UnitX();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Corner& a = corners_[i];
    const Corner& b = corners_[(i + 1) % corners_.size()];
    const Vector2d edge = b.place - a.place;
    edges_.push_back({edge, edge.norm(), !(a.at_border && b.at_border)});
    const Extents e = extents(edge / edges_.back().length);
    if (e.length() * e.width() < smallest) {
      smallest = e.length() * e.width();
      along_smallest = edge;
    }
  }
  add_orientation(along_smallest);
  if (touches_border_) {
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.length > b.length; });
    for (const Edge& edge : edges_) {
      if (edge.own && orientations_.size() < kMaxOrientations) {
        add_orientation(edge.along);
      }
    }
  }
}

bool RegionShape::is_cut_off(const Vector2d& direction) const {
  double farthest = -1e9;
  for (const Corner& corner : corners_) {
    farthest = std::max(farthest, direction.dot(corner.place));
  }
  return std::all_of(corners_.begin(), corners_.end(), [&](const Corner& corner) {
    return corner.at_border || direction.dot(corner.place) < farthest - 2.0 * grow_;
  });
}

}  // namespace luminav
