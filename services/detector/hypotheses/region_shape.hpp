#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/detector/hypotheses/cell_plane.hpp"
#include "services/detector/segmentation/regions.hpp"

namespace luminav {

/// A region's hull on the reference ceiling, and how far it reaches in a direction.
class RegionShape {
 public:
  struct Extents {
    double min_along, max_along, min_across, max_across;  // [m]

    [[nodiscard]] double length() const { return max_along - min_along; }
    [[nodiscard]] double width() const { return max_across - min_across; }
    [[nodiscard]] double middle_along() const { return 0.5 * (min_along + max_along); }
    [[nodiscard]] double middle_across() const { return 0.5 * (min_across + max_across); }
  };
  /// A direction in which an outline may lie.
  struct Orientation {
    double theta = 0.0;
    Eigen::Vector2d along = Eigen::Vector2d::UnitX();
    Extents extents{};

    [[nodiscard]] Eigen::Vector2d across() const { return {-along.y(), along.x()}; }
  };

  /// `shrunk`: cells by which the region was eroded on every side. False when it has no area, or goes beyond what the
  /// camera sees of the ceiling.
  bool take(const Region& region, int shrunk, const CellPlane& plane);

  /// The direction of the smallest rectangle round the hull and the one at right angles to it, and, where the border
  /// cuts the region, those of its longest own edges. Valid until the next region is taken.
  [[nodiscard]] const std::vector<Orientation>& orientations() const { return orientations_; }
  [[nodiscard]] bool touches_border() const { return touches_border_; }
  /// True when the border cuts off what reaches farthest in a direction, all of it.
  [[nodiscard]] bool is_cut_off(const Eigen::Vector2d& direction) const;
  [[nodiscard]] double area() const { return area_; }                // [m^2] before it was eroded
  [[nodiscard]] double eroded_area() const { return eroded_area_; }  // [m^2] as it is
  [[nodiscard]] double cell_size() const { return cell_size_; }      // [m]
  [[nodiscard]] const std::vector<Eigen::Vector2i>& hull_cells() const { return hull_; }

 private:
  struct Corner {
    Eigen::Vector2d place;  // [m] on the reference ceiling
    bool at_border;
  };
  struct Edge {             // of the hull
    Eigen::Vector2d along;  // as long as the edge
    double length;          // [m]
    bool own;               // not along the image border
  };
  [[nodiscard]] double hull_length() const;  // [m] all around, through cell centres
  void choose_orientations();
  void add_orientation(const Eigen::Vector2d& edge);
  [[nodiscard]] Extents extents(const Eigen::Vector2d& along) const;  // a direction

  std::vector<Eigen::Vector2i> hull_;
  std::vector<Eigen::Vector2i> right_;  // side of it
  std::vector<Corner> corners_;
  std::vector<Edge> edges_;
  std::vector<Orientation> orientations_;
  bool touches_border_ = false;
  double grow_ = 0.0;  // [m] from cell centres to the region's edge
  double area_ = 0.0;
  double eroded_area_ = 0.0;
  double cell_size_ = 0.0;
};

}  // namespace luminav
