#pragma once

#include <cstddef>

#include "services/planner/path/path_shaping.hpp"

namespace luminav {

/// Index of the point nearest to `position` [m, world] on the next 3 m of a path from point `at` on: forward only, so
/// that paths which cross themselves are not cut short.
std::size_t nearest_ahead(const Polyline& points, std::size_t at, const Eigen::Vector2d& position);

/// From `position` along the points behind `at`; of a path that ends there, its last point.
Polyline rest_of(const Polyline& points, std::size_t at, const Eigen::Vector2d& position);

}  // namespace luminav
