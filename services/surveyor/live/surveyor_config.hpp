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
  std::filesystem::path folder;   // of the survey: its log, and at the end the building
  std::filesystem::path state{};  // of the robot: its localizer begins where the survey ended; "" = it is told nothing

  [[nodiscard]] std::filesystem::path tried_file() const { return folder / "tried-floor.txt"; }
  [[nodiscard]] std::filesystem::path log_file() const { return folder / "survey.lcm"; }
};

/// Reads the robot's file, the file of kinds and the building to go on with; one of these two may be "". Throws
/// ConfigurationError.
SurveyorConfig read_surveyor_config(const std::filesystem::path& robot_file, const std::filesystem::path& kinds_file,
                                    const std::filesystem::path& folder,
                                    const std::filesystem::path& building_file = {});

}  // namespace luminav
