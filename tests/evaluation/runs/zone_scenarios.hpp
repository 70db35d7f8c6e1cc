#pragma once

#include <filesystem>
#include <vector>

namespace luminav {

inline constexpr int kZoneMissions = 200;

/// Writes the missions that zones are measured with, as `zones-1000.toml` and so on; the number is the seed to run it
/// with. Over all buildings in turn but the symmetric corridor, each with a file of its own that has five drawn zones
/// (two keep-out, two slow, of which one is quiet in every other mission, and a one-way zone), a told start, a
/// calibrated robot and two drawn goals; those that the zones take away are to be refused. In every eighth the robot is
/// carried into a keep-out zone on its way. Same files each time.
std::vector<std::filesystem::path> make_zone_missions(const std::filesystem::path& folder);

}  // namespace luminav
