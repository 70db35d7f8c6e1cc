// Makes a building of the log of a drive: what scripts/survey runs.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/localizer/robot_errors.hpp"
#include "services/surveyor/building_drawing.hpp"
#include "services/surveyor/drive/sonar_map.hpp"
#include "services/surveyor/drive/survey_log.hpp"
#include "services/surveyor/drive/survey_report.hpp"
#include "services/surveyor/survey/straightening.hpp"

namespace {

using namespace luminav;
namespace fs = std::filesystem;

struct Request {
  std::string log;
  std::string robot;
  std::string kinds;
  std::string out;
  std::string json;
  std::string png;
  bool detections = false;
};

SurveyModel model_of(const Request& request) {
  SurveyModel model;
  model.robot = read_robot(request.robot);
  model.kinds = read_ceiling_kinds(request.kinds);
  const RobotErrors believed = read_robot_errors(TomlTable::load(request.robot).table("localizer"));
  model.errors = believed.errors;
  model.wheels = believed.wheels;
  return model;
}

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

void print(const Survey& survey, const CeilingKinds& kinds, const std::vector<std::string>& remarks) {
  std::size_t passes = 0;
  double worst = 0.0;
  for (std::size_t f = 0; f < survey.fixtures.size(); ++f) {
    passes += survey.estimate.fixtures[f].passes.size();
    worst = std::max(worst, survey.fixtures[f].sigma_along);
  }
  fmt::print(
      "{:.0f} m, {} images used; {} fixtures of {} kinds in {} passes, known to {:.2f} m or better; {} dropped\n",
      survey.distance, survey.frames.size(), survey.fixtures.size(), kinds.kinds.size(), passes, worst,
      survey.dropped.size());
  for (const std::string& remark : remarks) {
    fmt::print("note: {}\n", remark);
  }
}

int run(const Request& request) {
  const fs::path folder = fs::absolute(request.out).lexically_normal();
  if (fs::exists(folder / "building.toml")) {
    throw std::runtime_error(fmt::format("{}: is there already", (folder / "building.toml").string()));
  }
  const SurveyModel model = model_of(request);
  const SurveyLog log =
      read_survey_log(request.log, request.robot, model.kinds,
                      request.detections ? SightingSource::kDetections : SightingSource::kImagesElseDetections);
  Survey survey = survey_drive(log.drive, model);
  const SurveyedPath path(log.drive.odometry, survey.frames, survey.estimate.poses);
  PriorMap map = draw_sonar_map(log.drive.echoes, path, model.robot, extents_of(survey, model.kinds));
  transform(survey.estimate, {-map.geometry.origin.x(), -map.geometry.origin.y(), 0.0});
  map.geometry.origin.setZero();
  const std::vector<std::string> remarks = remarks_on(survey, log, model.kinds);
  const std::string name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  const Building building = building_of(survey, model.kinds, name);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  write_map(folder / "map.yaml", map);
  if (!request.json.empty()) {
    write_whole_file(request.json, survey_json(survey, model.kinds, remarks));
  }
  if (!request.png.empty()) {
    draw_building_png(request.png, building, &map, unsure_fixtures(survey));
  }
  write_building(folder / "building.toml", building);  // last: where it is, the rest is too
  print(survey, model.kinds, remarks);
  fmt::print("{}: look at it with scripts/check-building\n", (folder / "building.toml").string());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  std::vector<std::string> logs;
  CommandLine line("survey", "Makes a building's folder, with fixtures and map, of the log of one drive through it.");
  line.robot_file(request.robot);
  line.positional("log", logs, "LCM log with ODOMETRY, SONAR and FIXTURE_DETECTIONS or CAMERA_IMAGE", true)
      .text("--kinds", request.kinds, "TOML file with ceiling_height and a [[kind]] for each kind of fixture", true)
      .text("--out", request.out, "new folder for building.toml and map.yaml", true)
      .flag("--detections", request.detections, "take the log's detections, also where it has images")
      .output_file("--json", request.json,
                   "write all figures there: uncertainties, what was dropped, what is not closed")
      .output_file("--png", request.png, "draw it: fixtures that are not sure in red");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("survey", [&] {
    if (logs.size() != 1) {
      throw ConfigurationError(fmt::format("found {} logs, must be one", logs.size()));
    }
    request.log = logs.front();
    return run(request);
  });
}
