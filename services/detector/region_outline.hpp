#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <vector>

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/ceiling_catalogue.hpp"
#include "services/detector/outline_fit.hpp"
#include "services/detector/regions.hpp"

namespace luminav {

/// Where each cell of a reduced image lies on the ceiling; made once per camera.
class CellPlane {
 public:
  /// Cells are factor x factor pixels.
  CellPlane(const CeilingCamera& camera, int factor, double height);

  /// Robot frame [m]; not a number where the ray does not reach the ceiling within `kFarthest` heights.
  [[nodiscard]] Eigen::Vector2d at(int column, int row) const;
  /// Side of a cell on the ceiling [m], at its largest.
  [[nodiscard]] double cell_size(int column, int row) const;
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double ceiling_height() const { return ceiling_height_; }
  [[nodiscard]] Eigen::Vector2d camera_foot() const { return camera_foot_; }
  [[nodiscard]] double camera_height() const { return camera_height_; }

  static constexpr double kFarthest = 4.0;

 private:
  int width_;
  int height_;
  double ceiling_height_;
  Eigen::Vector2d camera_foot_;
  double camera_height_;
  std::vector<Eigen::Vector2f> points_;
};

/// A guess of what a region shows, to be proved or refuted by its edges.
struct OutlineHypothesis {
  int kind = 0;  // index into the catalogue's fixtures, or elements
  bool is_element = false;
  bool half_width = false;  // one lamp's half of a fixture of two
  Outline outline;
  Pose2 start;
  double swelling = 0.0;   // [m] by which the region is wider on each side
  double uneven = 0.0;     // [m] by which it is wider than longer than the outline; of a whole one, or nothing is said
  bool from_edge = false;  // guessed from one edge of a region whose other side is something else's
};

struct SizeTolerance {
  double absolute = 0.05;      // [m]
  double share = 0.12;         // of the side
  double bloom = 0.0;          // [m] by which light may widen a region, in total
  double least_visible = 0.3;  // share of a cut fixture's length
};

/// Turns regions into guesses: the convex hull is taken to the ceiling, its main directions are tried, and the extents
/// along and across are compared with what hangs on this ceiling. Where the image border cuts the hull, an outline is
/// tried at each end that may be in view, and one for which only the sides count; where it cuts off a long side, one
/// that starts from the other.
class OutlineProposer {
 public:
  OutlineProposer(const CellPlane& plane, const CeilingCatalogue& catalogue) : plane_(&plane), catalogue_(&catalogue) {}

  /// `shrunk`: cells by which the region was eroded on every side. Valid until the next call.
  const std::vector<OutlineHypothesis>& propose(const Region& region, int shrunk, bool bright,
                                                const SizeTolerance& tolerance);
  /// Hull of the last region as [column, row] of cells.
  [[nodiscard]] const std::vector<Eigen::Vector2i>& hull_cells() const { return hull_; }

 private:
  struct Corner {
    Eigen::Vector2d place;  // [m] on the reference ceiling
    bool at_border;
  };
  struct Edge {  // of the hull
    double length;
    bool own;               // not along the image border
    Eigen::Vector2d start;  // [m] on the reference ceiling
    Eigen::Vector2d end;

    [[nodiscard]] double theta() const { return std::atan2(end.y() - start.y(), end.x() - start.x()); }
  };
  struct Extents {
    double least_along, most_along, least_across, most_across;
  };
  /// One way in which outlines may lie, and how far the hull reaches along and across it.
  struct Way {
    double theta;
    Eigen::Vector2d along;
    Extents extents;  // [m] on the reference ceiling

    [[nodiscard]] Eigen::Vector2d across() const { return {-along.y(), along.x()}; }
  };
  struct Placing {
    double scale;  // from the reference ceiling to the kind's height
    double width;  // [m]
    int index;     // of the kind
    bool half_width;
    double swelling = 0.0;  // [m]
    double uneven = 0.0;    // [m]
  };
  bool take_hull(const Region& region);
  [[nodiscard]] Extents extents(const Eigen::Vector2d& along) const;  // a direction
  [[nodiscard]] Way way_at(double theta) const;
  void choose_directions();
  void propose_kind(const CeilingKind& kind, int index, bool half_width, bool bright, const Way& way,
                    const SizeTolerance& tolerance);
  /// Outlines of which one long side is beyond the image border.
  void propose_from_one_side(const CeilingKind& kind, int index, const Way& way, const SizeTolerance& tolerance);
  /// Outlines of which an edge of a hull that is too wide is one long side: shading or a neighbour joined the rest.
  void propose_from_an_edge(const CeilingKind& kind, int index, const Edge& edge, const SizeTolerance& tolerance);
  /// An outline that lies so, with its middle there, `along` and `across` [m] on the reference ceiling.
  void add(const CeilingKind& kind, const Placing& placing, const Way& way, double along, double across);
  /// Light makes a region longer by as much as wider: guesses of which that is truest come first.
  void put_in_order();
  /// True when what reaches farthest in a direction is all of it cut off by the border, false when some of it is.
  [[nodiscard]] bool is_cut_off(const Eigen::Vector2d& direction) const;

  const CellPlane* plane_;
  const CeilingCatalogue* catalogue_;
  std::vector<Eigen::Vector2i> points_;
  std::vector<Eigen::Vector2i> hull_;
  std::vector<Corner> corners_;
  std::vector<Edge> edges_;
  std::vector<double> directions_;
  std::vector<Way> ways_;  // each direction, then at right angles to it
  std::vector<OutlineHypothesis> hypotheses_;
  bool touches_border_ = false;
  double grow_ = 0.0;  // [m] from cell centres to the region's edge
};

}  // namespace luminav
