#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/detector/hypotheses/cell_plane.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"
#include "services/detector/segmentation/regions.hpp"

namespace luminav {

/// How coarsely an image may be looked at to find what hangs on a ceiling, and how small and large regions of that are.
struct RegionLimits {
  RegionLimits(const ModernDetectorParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue);

  /// False when it is larger than everything that hangs here.
  [[nodiscard]] bool may_be_a_kind(const Region& region, const CellPlane& plane) const;

  static constexpr double kMinAcross = 16.0;  // [px] any dark groove looks like a narrower lamp, any speck like a disc

  int factor = 1;             // [px] side of a cell, clearly smaller than the narrowest fixture
  int window_radius = 0;      // [cells] of surroundings
  int bare_radius = 0;        // [cells] the same for bare battens; 0: there are none
  int min_cells = 0;          // of a region
  double min_length = 1e9;    // [m] of all kinds
  double max_extent = 0.0;    // [m] of a region
  double max_area = 0.0;      // [m^2]
  bool is_narrow = false;     // all that hangs here, too narrow to be told from grooves when it is dark
  bool is_eroded = false;     // of dark regions, by a cell
  bool ignore_lines = false;  // between tiles
};

}  // namespace luminav
