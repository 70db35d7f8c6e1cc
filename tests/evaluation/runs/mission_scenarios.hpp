#pragma once

#include <filesystem>
#include <vector>

namespace luminav {

inline constexpr int kMissions = 100;
inline constexpr int kGoalsPerMission = 5;

/// Writes the missions that navigation is measured with, as `mission-1000.toml` and so on; the number is the seed to
/// run it with. Over all buildings in turn, each with five drawn goals, boxes that no map has, two to four walking
/// people in three of four, and in buildings with doors one that is closed, which the map doesn't know; goals behind it
/// alone are to be refused. The start is told and the robot calibrated. Same files each time.
std::vector<std::filesystem::path> make_missions(const std::filesystem::path& folder);

}  // namespace luminav
