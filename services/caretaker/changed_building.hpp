#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/caretaker/ceiling_changes.hpp"

namespace luminav {

/// The text of a building.toml with changes made: a moved fixture's x, y and theta, a removed one's table, a new one's
/// appended. All else stays, comments included. Throws ConfigurationError when the file has no such fixture.
std::string with_changes(const std::filesystem::path& file, const std::vector<CeilingChange>& changes);

/// Writes it, and keeps the text as it was in a file beside it, whose name has the date of `utime` [us]. Returns that
/// file. The outcome must read as a building, else nothing is written. Throws ConfigurationError or
/// std::runtime_error.
std::filesystem::path change_building(const std::filesystem::path& file, const std::vector<CeilingChange>& changes,
                                      std::int64_t utime);

}  // namespace luminav
