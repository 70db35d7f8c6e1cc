#pragma once

#include <optional>

#include "services/common/building/occupancy_grid.hpp"
#include "tests/replay/replay_run.hpp"

namespace luminav {

/// Not measured unless there are both, of one size.
MapComparison compare_maps(const std::optional<OccupancyGrid>& recorded, const std::optional<OccupancyGrid>& replayed);

/// Adds a sentence to the report's failures for each figure beyond its tolerance.
void append_verdict(const ReplayTolerances& limit, ReplayReport& report);

}  // namespace luminav
