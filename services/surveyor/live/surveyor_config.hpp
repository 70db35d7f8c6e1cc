#pragma once

#include <filesystem>

#include "services/detector/detector_config.hpp"
#include "services/surveyor/drive/survey_log.hpp"
#include "services/surveyor/explore/exploration.hpp"
#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

struct SurveyorConfig {
  SurveyModel model;
  DetectorConfig detector;
  SightingSource source = SightingSource::kImagesElseDetections;
  ExplorationParams exploration;
  std::filesystem::path folder;  // of the survey: its log, and at the end the building

  [[nodiscard]] std::filesystem::path log_file() const { return folder / "survey.lcm"; }
};

/// Reads the robot's file and the file of kinds. Throws ConfigurationError.
SurveyorConfig read_surveyor_config(const std::filesystem::path& robot_file, const std::filesystem::path& kinds_file,
                                    const std::filesystem::path& folder);

}  // namespace luminav
