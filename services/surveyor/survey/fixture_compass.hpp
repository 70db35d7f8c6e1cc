#pragma once

#include <vector>

#include "services/surveyor/survey/fixture_passes.hpp"

namespace luminav {

/// Turns a path (world_from_robot of each key frame) on its way so that the fixtures it passes keep their heading
/// modulo a quarter turn. Where buildings have right angles this is a compass: by its wheels alone a path of a
/// kilometre turns by half a radian, and nothing at its end is recognised. What hangs askew among many that do not
/// turns it little.
std::vector<Pose2> hold_heading(const std::vector<Pose2>& path, const std::vector<FixturePass>& passes);

}  // namespace luminav
