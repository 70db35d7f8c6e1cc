#pragma once

#include <optional>
#include <vector>

#include "services/detector/hypotheses/region_shape.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"
#include "services/detector/outline/outline.hpp"

namespace luminav {

/// A guess of what a region shows, to be proved or refuted.
struct OutlineHypothesis {
  int kind = 0;                   // index into the catalogue's fixtures
  int burning = 0;                // of its lamps, side by side, the outline holds; 0: it holds the fixture
  bool is_whole = false;          // the region shows all of it
  std::optional<Side> drowned{};  // long side that a glow hides, as bright as the lamp
  Outline outline;
  OutlinePlacement start;   // as large as the region shows it
  double size_error = 0.0;  // by which the region is longer, bloom taken off, as a share of the length; of whole ones
  double fill = 1.0;        // the region's area, of its rectangle's; of whole ones
};

struct SizeTolerance {
  double share = 0.16;       // of a side: sizes within 10 %, heights within 5 %
  double ragged = 0.02;      // [m] by which noise and grid lines may change a side
  double bloom = 0.0;        // [m] by which light may widen a region on each side
  double min_visible = 0.3;  // share of a cut fixture's length
  double min_width = 0.0;    // [m] of what need not be whole and of its length
  bool is_bare = false;      // between shadows, about as bright as the ceiling: its region is ragged
  bool is_white = false;     // all of it: what shines beside a lamp is as bright as the lamp
};

/// Turns regions into guesses of what hangs on this ceiling, in metres. Where the image border cuts a region, an
/// outline is tried at each end that may be in view; where it cuts off a long side, one that starts from the other.
class OutlineProposer {
 public:
  static constexpr double kMaxBare = 0.2;   // [m] of width; wider fixtures have covers or louvres
  static constexpr double kMaxGlow = 0.25;  // width of a lamp with the glow beside it, of its length

  OutlineProposer(const CellPlane& plane, const CeilingCatalogue& catalogue) : plane_(&plane), catalogue_(&catalogue) {}

  /// Best size first. Valid until the next call.
  const std::vector<OutlineHypothesis>& propose(const RegionShape& shape, bool bright, const SizeTolerance& tolerance);

 private:
  /// A kind, or what some of its lamps light, seen on the reference ceiling.
  struct Target {
    const CeilingKind* kind;
    int index;
    int burning;   // 0: the kind
    double scale;  // from the reference ceiling to the kind's height

    [[nodiscard]] double width() const { return burning > 0 ? kind->width * burning / kind->lamps : kind->width; }
    [[nodiscard]] int tubes() const { return burning > 0 ? burning : kind->lamps; }
  };
  void propose_kind(const Target& target, const RegionShape& shape, const SizeTolerance& tolerance, bool bright);
  void propose_whole(const Target& target, const RegionShape& shape, const RegionShape::Orientation& orientation,
                     const SizeTolerance& tolerance);
  void propose_cut(const Target& target, const RegionShape& shape, const RegionShape::Orientation& orientation,
                   const SizeTolerance& tolerance);
  /// Outlines of which one long side is beyond the image border.
  void propose_from_one_side(const Target& target, const RegionShape& shape,
                             const RegionShape::Orientation& orientation, const SizeTolerance& tolerance);
  /// A lamp along either long side of a region that is too wide: beside a tube on a wall or a beam the light falls on
  /// one side only.
  void propose_beside_glow(const Target& target, const RegionShape& shape, const RegionShape::Orientation& orientation,
                           const SizeTolerance& tolerance);
  /// An outline with its middle there, `along` and `across` [m] on the reference ceiling.
  OutlineHypothesis& add(const Target& target, const RegionShape::Orientation& orientation, double along,
                         double across);

  const CellPlane* plane_;
  const CeilingCatalogue* catalogue_;
  std::vector<OutlineHypothesis> hypotheses_;
};

}  // namespace luminav
