#pragma once

#include <string>

#include "services/surveyor/survey/survey.hpp"
#include "tests/unit/recorded_ceiling/light_grid.hpp"

namespace luminav::testing {

/// What a survey makes of the recording: visual increments stand in for the wheels, and no reference pose is looked at.
struct RecordedSurvey {
  SurveyModel model;
  Survey survey;
  LightGrid grid;  // in which its fixtures hang
};

/// Surveys the recording with the camera of one of its robot files. The increments' own uncertainty is the odometry's.
/// Throws when something is missing.
RecordedSurvey survey_recording(const std::string& robot);

}  // namespace luminav::testing
