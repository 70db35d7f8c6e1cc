#pragma once

#include <cstdint>
#include <string>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Which lamps an electrician bought for the whole floor.
enum class FixtureKind {
  kTubes,       // 1.2 x 0.3 m with two tubes in rooms, 1.2 x 0.15 m with one in corridors
  kPanels,      // square ones of 0.6 m everywhere
  kDownlights,  // round ones of 0.25 m in corridors, panels in rooms
  kMixed        // drawn room by room
};

struct FloorPlanParams {
  std::string name = "generated";
  double width = 60.0;        ///< [m] outer size along x
  double depth = 40.0;        ///< [m] outer size along y
  double pitch = 2.8;         ///< [m] between neighbouring fixtures
  double irregularity = 0.3;  ///< 0 = every room like the next; 1 = shifted, missing and turned fixtures, uneven rooms
  double ceiling_height = 2.8;  ///< [m]
  double resolution = 0.05;     ///< [m] of the map's cells
  FixtureKind kind = FixtureKind::kTubes;
  std::uint64_t seed = 1;
};

/// A building and its map; the building's `map_file` is left empty.
struct FloorPlan {
  Building building;
  PriorMap map;
};

/// A plausible office floor: corridors every two rooms' depth, joined to loops at their ends, rooms with a door to the
/// corridor on both sides, fixtures at a regular pitch, vents and smoke detectors, windows on the long outer walls, a
/// place in each room. Same params, same plan. Throws ConfigurationError for a size that holds no corridor with rooms.
FloorPlan make_floor_plan(const FloorPlanParams& params);

/// Hangs fixtures over the free space of a given map, at `pitch`, in the middle of what is narrow. Rooms are not told
/// apart, so doors, windows and places stay empty. Uses name, pitch, irregularity, ceiling_height, kind and seed.
FloorPlan light_map(const PriorMap& map, const FloorPlanParams& params);

}  // namespace luminav
