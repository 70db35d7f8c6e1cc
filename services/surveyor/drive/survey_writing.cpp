#include "services/surveyor/drive/survey_writing.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/localizer/pose_memory.hpp"
#include "services/localizer/robot_errors.hpp"
#include "services/surveyor/building_drawing.hpp"
#include "services/surveyor/drive/plan_alignment.hpp"
#include "services/surveyor/drive/pose_at.hpp"
#include "services/surveyor/drive/sonar_map.hpp"
#include "services/surveyor/drive/survey_report.hpp"
#include "services/surveyor/survey/straightening.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

constexpr double kEndSigma = 0.10;         // [m] of where the robot is at the end of a drive,
constexpr double kEndTurn = radians(2.0);  // [rad] likewise

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

PriorMap map_of(const Survey& survey, const SurveyLog& log, const SurveyModel& model) {
  const bool has_walls = survey.is_placed && model.known->map;
  return draw_sonar_map(log.drive.echoes, SurveyedPath(log.drive.odometry, survey.frames, survey.estimate.poses),
                        model.robot, extents_of(survey, model.kinds), has_walls ? &*model.known->map : nullptr);
}

/// How a survey lies in the frame of a file; nothing where that is not clear.
std::optional<Pose2> alignment_of(const Survey& survey, const PriorMap& map, const SurveyModel& model,
                                  const fs::path& file) {
  const bool is_plan = file.extension() == ".yaml" || file.extension() == ".yml";
  return is_plan ? align_with_walls(survey, map, read_map(file)) : align_with_fixtures(survey, model, file);
}

/// Moves a survey that lies in a frame of its own into that of the file, or its map's corner to the origin.
PriorMap settle_frame(Survey& survey, const SurveyLog& log, const SurveyModel& model, const fs::path& align,
                      std::vector<std::string>& remarks) {
  PriorMap map = map_of(survey, log, model);
  const std::optional<Pose2> moved = align.empty() ? std::nullopt : alignment_of(survey, map, model, align);
  if (moved) {
    transform(survey.estimate, *moved);
    for (JudgedFixture& fixture : survey.fixtures) {
      fixture.covariance = turned(fixture.covariance, moved->theta);
    }
    return map_of(survey, log, model);
  }
  if (!align.empty()) {
    remarks.push_back(
        fmt::format("{}: nothing clear to align with was found; the map keeps axes of its own", align.string()));
  }
  transform(survey.estimate, {-map.geometry.origin.x(), -map.geometry.origin.y(), 0.0});
  map.geometry.origin.setZero();
  return map;
}

/// Tells the localizer of a robot that goes on where the drive ended.
void tell_localizer(const WrittenSurvey& written, const SurveyLog& log, const fs::path& state) {
  const OdometryReading& last = log.drive.odometry.back();
  const SurveyEstimate& estimate = written.survey.estimate;
  const std::optional<Pose2> pose = pose_at(written.survey.frames, estimate.poses, log.drive.odometry, last.utime);
  if (!pose || state.empty()) {
    return;
  }
  const Eigen::Vector3d sigma(kEndSigma, kEndSigma, kEndTurn);
  (void)PoseMemory(state, written.building)
      .save({written.building.name,
             static_cast<int>(written.building.fixtures.size()),
             last.session,
             last.odom_from_robot,
             {*pose, sigma.cwiseAbs2().asDiagonal()}});
}

/// "map/" and "map" are one name.
fs::path tidy(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

}  // namespace

SurveyModel read_survey_model(const fs::path& robot_file, const fs::path& kinds_file, const fs::path& building_file) {
  SurveyModel model;
  model.robot = read_robot(robot_file);
  if (!kinds_file.empty()) {
    model.kinds = read_ceiling_kinds(kinds_file);
  } else if (building_file.empty()) {
    throw ConfigurationError("--kinds is missing: without a building to begin with nobody knows what hangs there");
  }
  if (!building_file.empty()) {
    model.known = read_known_building(building_file, model.kinds);
  }
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
  if (model.known && !survey.is_placed) {
    throw std::runtime_error(why_not_placed(survey, model));
  }
  std::vector<std::string> of_frame;
  const PriorMap map =
      survey.is_placed ? map_of(survey, log, model) : settle_frame(survey, log, model, files.align, of_frame);
  written.remarks = remarks_on(survey, log, model);
  written.remarks.insert(written.remarks.begin(), of_frame.begin(), of_frame.end());
  const fs::path folder = tidy(files.folder);
  written.building = building_of(survey, log, model, folder.filename().string());
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  write_map(folder / "map.yaml", map);
  if (!files.json.empty()) {
    write_whole_file(files.json, survey_json(survey, model, written.remarks));
  }
  if (!files.png.empty()) {
    draw_building_png(files.png, written.building, &map, unsure_fixtures(survey, model));
  }
  tell_localizer(written, log, files.state);
  write_building(folder / "building.toml", written.building);
  return written;
}

}  // namespace luminav
