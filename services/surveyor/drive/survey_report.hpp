#pragma once

#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/surveyor/drive/survey_log.hpp"
#include "services/surveyor/survey/survey.hpp"

namespace luminav {

/// The surveyed building: fixtures that are believed, numbered along the drive, the place where the drive began, and
/// those that were named on the way; a person's "start" takes the place of ours. One that goes on with a known building
/// keeps all that this has, and the numbers of its fixtures; new ones are numbered behind them. It lists all fixtures
/// if the robot explored until nothing was left, or if a file did that lacks none.
Building building_of(const Survey& survey, const SurveyLog& log, const SurveyModel& model, const std::string& name);

/// What a person has to know of a survey beside the building, in plain sentences: what was wrong with the log or the
/// file of kinds, what was left out, where the map is not sure and where to drive once more.
std::vector<std::string> remarks_on(const Survey& survey, const SurveyLog& log, const SurveyModel& model);

/// Why a survey does not go on with the known building, with what may be wrong.
std::string why_not_placed(const Survey& survey, const SurveyModel& model);

/// A survey's figures as JSON text: each fixture with its uncertainty, what was dropped and why, what is not closed,
/// wheels and camera as the drive found them, and the remarks.
std::string survey_json(const Survey& survey, const SurveyModel& model, const std::vector<std::string>& remarks);

/// Numbers (as in the building) of the fixtures that the survey is not sure of.
std::vector<int> unsure_fixtures(const Survey& survey, const SurveyModel& model);

}  // namespace luminav
