#include "services/surveyor/drive/survey_writing.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/localizer/robot_errors.hpp"
#include "services/surveyor/building_drawing.hpp"
#include "services/surveyor/drive/sonar_map.hpp"
#include "services/surveyor/drive/survey_report.hpp"
#include "services/surveyor/survey/straightening.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

/// Points on the floor below the fixtures and as far beside them as they are long.
std::vector<Eigen::Vector2d> extents_of(const Survey& survey, const CeilingKinds& kinds) {
  std::vector<Eigen::Vector2d> points;
  for (const SurveyedFixture& fixture : survey.estimate.fixtures) {
    const double reach = kinds.kinds[static_cast<std::size_t>(fixture.kind)].length;
    for (const Eigen::Vector2d& beside : {Eigen::Vector2d(reach, reach), Eigen::Vector2d(-reach, -reach)}) {
      points.push_back(fixture.world_from_fixture.position() + beside);
    }
  }
  return points;
}

/// "map/" and "map" are one name.
fs::path tidy(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

SurveyModel read_survey_model(const fs::path& robot_file, const fs::path& kinds_file) {
  SurveyModel model;
  model.robot = read_robot(robot_file);
  model.kinds = read_ceiling_kinds(kinds_file);
  const RobotErrors believed = read_robot_errors(TomlTable::load(robot_file).table("localizer"));
  model.errors = believed.errors;
  model.wheels = believed.wheels;
  return model;
}

void refuse_a_building_in(const fs::path& folder) {
  const fs::path file = tidy(folder) / "building.toml";
  if (fs::exists(file)) {
    throw std::runtime_error(fmt::format("{}: is there already", file.string()));
  }
}

WrittenSurvey write_survey(const SurveyLog& log, const SurveyModel& model, const SurveyFiles& files) {
  refuse_a_building_in(files.folder);
  WrittenSurvey written;
  Survey& survey = written.survey;
  survey = survey_drive(log.drive, model);
  PriorMap map =
      draw_sonar_map(log.drive.echoes, SurveyedPath(log.drive.odometry, survey.frames, survey.estimate.poses),
                     model.robot, extents_of(survey, model.kinds));
  transform(survey.estimate, {-map.geometry.origin.x(), -map.geometry.origin.y(), 0.0});
  map.geometry.origin.setZero();
  written.remarks = remarks_on(survey, log, model.kinds);
  const fs::path folder = tidy(files.folder);
  written.building = building_of(survey, log, model.kinds, folder.filename().string());
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  write_map(folder / "map.yaml", map);
  if (!files.json.empty()) {
    write_whole_file(files.json, survey_json(survey, model.kinds, written.remarks));
  }
  if (!files.png.empty()) {
    draw_building_png(files.png, written.building, &map, unsure_fixtures(survey));
  }
  write_building(folder / "building.toml", written.building);
  return written;
}

}  // namespace luminav
