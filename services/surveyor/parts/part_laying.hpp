#pragma once

#include <vector>

#include "services/surveyor/survey/survey.hpp"

namespace luminav {

/// Lays the parts of a drive on one map: first those that begin where the one before ended, then those that lie on the
/// known building, or else on the longest, by what both saw. What cannot be placed is left out.
Survey lay_parts(const std::vector<Survey>& parts, const SurveyModel& model, const std::vector<ToldPose>& told);

}  // namespace luminav
