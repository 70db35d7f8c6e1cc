#pragma once

#include <cstdint>
#include <vector>

#include "services/surveyor/survey/fixture_passes.hpp"
#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

/// Times [us] at which the robot was lifted: the wheels stood, and what is in view at the end of that is not what was
/// at the beginning.
std::vector<std::int64_t> find_lifts(const SurveyDrive& drive);

/// Key frames before which somebody carried the robot: fixtures vanished from the middle of the view while others
/// appeared in it elsewhere, and the wheels know nothing of it. Where nothing hung before or after, nobody can tell.
std::vector<int> find_carries(const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes,
                              const SurveyModel& model);

/// Begins a new part of the drive at each of these key frames.
void split_at(std::vector<KeyFrame>& frames, const std::vector<int>& carries);

}  // namespace luminav
