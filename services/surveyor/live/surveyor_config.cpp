#include "services/surveyor/live/surveyor_config.hpp"

#include "services/surveyor/drive/survey_writing.hpp"

namespace luminav {
namespace {

constexpr double kRoom =
    0.0375;  // [m] beside the robot where it explores: what p3dx-mapping.toml lets the planner go by

}  // namespace

SurveyorConfig read_surveyor_config(const std::filesystem::path& robot_file, const std::filesystem::path& kinds_file,
                                    const std::filesystem::path& folder, const std::filesystem::path& building_file) {
  SurveyorConfig config;
  config.model = read_survey_model(robot_file, kinds_file, building_file);
  config.detector = read_detector_config(robot_file, building_of(config.model.kinds),
                                         kinds_file.empty() ? building_file : kinds_file);
  config.exploration.search.hard_radius = config.model.robot.inscribed_radius() + kRoom;
  config.folder = std::filesystem::absolute(folder).lexically_normal();
  return config;
}

}  // namespace luminav
