#pragma once

#include <string>

#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

/// `<`, `>`, `&` and quotes made harmless.
std::string html_escape(const std::string& text);

/// True way, belief and odometry over the map as an SVG; the map's picture is referred to by `map_id`, which
/// `map_symbol` defined.
std::string trajectory_svg(const RunReport& run, const std::string& map_id);

/// The map, once for all runs in it, as an SVG <symbol>; "" when it cannot be read.
std::string map_symbol(const RunReport& run, const std::string& map_id);

/// Position error over time, logarithmic, as an SVG; "" without a trail.
std::string error_svg(const RunReport& run);

}  // namespace luminav
