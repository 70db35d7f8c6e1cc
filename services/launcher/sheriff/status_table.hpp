#pragma once

#include <string>
#include <vector>

#include "services/launcher/sheriff/sheriff.hpp"

namespace luminav::launcher {

/// The state of everything as lines for a terminal: one per command, after them what is wrong with deputies. `width`
/// cuts long lines (0 = never).
std::vector<std::string> status_table(const Sheriff& sheriff, std::size_t width);

/// "0:07", "12:31", "3:00:00", "2d 04:10".
std::string format_duration(double seconds);

}  // namespace luminav::launcher
