#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/surveyor/drive/survey_log.hpp"
#include "services/surveyor/survey/survey.hpp"

namespace luminav {

/// Where a survey is written.
struct SurveyFiles {
  std::filesystem::path folder;   // of building.toml and map.yaml; made where it is missing
  std::filesystem::path json;     // all figures; "" = not written
  std::filesystem::path png;      // the plan; "" = not drawn
  std::filesystem::path state{};  // where the robot's localizer looks for its last pose; "" = it is told none
  std::filesystem::path align{};  // building.toml or map.yaml in whose frame it is written; "" = in one of its own
};

/// A survey as it was written: straight, the map's corner at the origin, or in the frame of another file.
struct WrittenSurvey {
  Survey survey;
  Building building;
  std::vector<std::string> remarks;
};

/// Reads what is known before the drive; of kinds and building one may be "". Throws ConfigurationError.
SurveyModel read_survey_model(const std::filesystem::path& robot_file, const std::filesystem::path& kinds_file,
                              const std::filesystem::path& building_file = {});

/// Throws std::runtime_error where the folder holds a building already: none is overwritten.
void refuse_a_building_in(const std::filesystem::path& folder);

/// Surveys a drive and writes its building: what scripts/survey does with a log, and the surveyor at the end of a
/// drive. building.toml comes last: where it is, the rest is too. Throws std::runtime_error as survey_drive does,
/// where it cannot be placed on the known building, and where something cannot be written or is there already. What it
/// could not align keeps axes of its own, and a remark says so.
WrittenSurvey write_survey(const SurveyLog& log, const SurveyModel& model, const SurveyFiles& files);

}  // namespace luminav
