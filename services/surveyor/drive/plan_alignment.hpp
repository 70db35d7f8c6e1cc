#pragma once

#include <filesystem>
#include <optional>

#include "services/common/building/occupancy_grid.hpp"
#include "services/surveyor/survey/survey.hpp"

namespace luminav {

/// How a survey lies on a building's file, by the fixtures that both have: file_from_survey; nothing where that is not
/// clear. Throws ConfigurationError for a file that is none.
std::optional<Pose2> align_with_fixtures(const Survey& survey, const SurveyModel& model,
                                         const std::filesystem::path& building_file);

/// How a survey lies on a floor plan, by the walls of both, in any of the four directions and up to 4 degrees beside
/// them: plan_from_survey; nothing where too little of the walls agrees, or another place does nearly as well.
/// `map` is the survey's. A correlative scan match (Olson 2009). Cost: seconds for 70 m x 50 m.
std::optional<Pose2> align_with_walls(const Survey& survey, const PriorMap& map, const PriorMap& plan);

}  // namespace luminav
