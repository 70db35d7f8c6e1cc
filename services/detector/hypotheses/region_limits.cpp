#include "services/detector/hypotheses/region_limits.hpp"

#include <algorithm>
#include <cmath>

#include "services/detector/hypotheses/outline_proposer.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kWindow = 1.45;    // times the widest: it may lie slantwise in a square window
constexpr double kMinWhole = 0.75;  // of the shortest, what is whole is no shorter ...
constexpr double kMinCut = 0.2;     // ... and what the border cuts
constexpr double kSlack = 1.4;      // times its size, and bloom, no region of a kind is larger

/// Of all fixtures; of one of two lamps half may burn alone.
struct SizeLimits {
  double min_width = 0.3;  // [m]
  double max_width = 0.1;  // [m]
  double min_area = 1e9;   // [m^2]
};

SizeLimits size_limits(const CeilingCatalogue& catalogue) {
  SizeLimits limits;
  for (const CeilingKind& kind : catalogue.fixtures) {
    limits.min_width = std::min(limits.min_width, kind.width);
    limits.max_width = std::max(limits.max_width, kind.width);
    limits.min_area = std::min(limits.min_area, kind.length * kind.width * (kind.lamps >= 2 ? 0.5 : 1.0));
  }
  return limits;
}

/// The largest pixel on the ceiling [m] within 50 degrees of the zenith: through a fisheye those far out are larger.
double coarsest_pixel(const CeilingCamera& camera, double height) {
  constexpr double kFarthest = 1.19;  // camera-to-ceiling distances
  const double farthest = kFarthest * (height - camera.mounting().z);
  const Vector2d foot(camera.mounting().x, camera.mounting().y);
  double coarsest = (height - camera.mounting().z) / camera.intrinsics().fx;
  for (int row = 0; row < camera.intrinsics().height; row += 16) {
    for (int column = 0; column < camera.intrinsics().width; column += 16) {
      const auto here = camera.point_on_ceiling({column, row}, height);
      const auto right = camera.point_on_ceiling({column + 1.0, static_cast<double>(row)}, height);
      const auto below = camera.point_on_ceiling({static_cast<double>(column), row + 1.0}, height);
      if (here && right && below && (*here - foot).norm() < farthest) {
        coarsest = std::max({coarsest, (*right - *here).norm(), (*below - *here).norm()});
      }
    }
  }
  return coarsest;
}

/// Cells must stay clearly smaller than the narrowest fixture.
int reduction_factor(const CeilingCamera& camera, const CeilingCatalogue& catalogue) {
  const double narrowest_px = size_limits(catalogue).min_width / coarsest_pixel(camera, catalogue.ceiling_height);
  return narrowest_px >= 20.0 ? 4 : narrowest_px >= 6.0 ? 2 : 1;
}

}  // namespace

RegionLimits::RegionLimits(const ModernDetectorParams& params, const CeilingCamera& camera,
                           const CeilingCatalogue& catalogue)
    : factor(reduction_factor(camera, catalogue)) {
  const SizeLimits sizes = size_limits(catalogue);
  const double cell = factor * (catalogue.ceiling_height - camera.mounting().z) / camera.intrinsics().fx;
  // wider than the widest fixture and its bloom, or its middle would count as surroundings
  window_radius = static_cast<int>(std::ceil(0.5 * (kWindow * sizes.max_width + 0.08) / cell));
  min_cells = std::max(6, static_cast<int>(0.5 * params.min_visible * sizes.min_area / (cell * cell)));
  for (const CeilingKind& kind : catalogue.fixtures) {
    if (kind.width <= OutlineProposer::kMaxBare && kind.shape != FixtureShape::kRound) {
      bare_radius = std::max(bare_radius, static_cast<int>(std::ceil(0.5 * (kind.width + 0.03) / cell)));
    }
    const double length = kSlack * kind.length + 2.0 * params.max_bloom;
    const double width = kSlack * kind.width + 2.0 * params.max_bloom;
    min_length = std::min(min_length, kind.length);
    max_extent = std::max(max_extent, std::hypot(length, width));
    max_area = std::max({max_area, length * width, OutlineProposer::kMaxGlow * length * length});
  }
  // grid lines between tiles are thinner than two cells; the narrowest fixture must survive
  is_narrow = sizes.max_width * factor < kMinAcross * cell;
  is_eroded = sizes.min_width / cell >= 5.0;
  ignore_lines = sizes.min_width / cell >= 7.5;
}

bool RegionLimits::may_be_a_kind(const Region& region, const CellPlane& plane) const {
  const auto [side, area] = plane.footprint((region.left + region.right) / 2, (region.top + region.bottom) / 2);
  const double shorter = area / side;  // tilt and lens stretch a cell
  const bool is_cut = plane.is_at_border(region.left, region.top) || plane.is_at_border(region.right, region.bottom);
  const double longest = side * std::hypot(region.right - region.left + 1, region.bottom - region.top + 1);
  return !(longest < (is_cut ? kMinCut : kMinWhole) * min_length) &&
         !(shorter * std::hypot(region.right - region.left, region.bottom - region.top) > max_extent) &&
         !(area * region.cells > max_area);  // no number says nothing
}

}  // namespace luminav
