// Makes a building of the log of a drive: what scripts/survey runs.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/process/command_line.hpp"
#include "services/surveyor/drive/survey_log.hpp"
#include "services/surveyor/drive/survey_writing.hpp"

namespace {

using namespace luminav;
namespace fs = std::filesystem;

struct Request {
  std::vector<std::string> logs;
  std::string robot;
  std::string kinds;
  std::string building;
  std::string align;
  std::string out;
  std::string json;
  std::string png;
  bool detections = false;
};

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
  refuse_a_building_in(request.out);  // before the log is read, which takes its time
  if (!request.building.empty() && !request.align.empty()) {
    throw ConfigurationError("--building and --align: one of them says what frame the survey is in");
  }
  const SurveyModel model = read_survey_model(request.robot, request.kinds, request.building);
  const SightingSource source =
      request.detections ? SightingSource::kDetections : SightingSource::kImagesElseDetections;
  std::vector<SurveyLog> logs;
  for (const std::string& file : request.logs) {
    logs.push_back(read_survey_log(file, request.robot, model.kinds, source));
  }
  const WrittenSurvey written =
      write_survey(one_after_another(logs), model, {request.out, request.json, request.png, "", request.align});
  print(written.survey, model.kinds, written.remarks);
  fmt::print("{}: look at it with scripts/check-building\n",
             (fs::absolute(request.out).lexically_normal() / "building.toml").string());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  CommandLine line("survey", "Makes a building's folder, with fixtures and map, of the logs of drives through it.");
  line.robot_file(request.robot);
  line.positional("log", request.logs,
                  "LCM logs with ODOMETRY, SONAR and FIXTURE_DETECTIONS or CAMERA_IMAGE, in the order driven", true)
      .text(
          "--kinds", request.kinds,
          "TOML file with ceiling_height and a [[kind]] for each kind of fixture; with --building only for what is new")
      .text("--building", request.building,
            "building file or folder to go on with: frame, names and fixtures hold (to what its [survey] says, else to "
            "2 cm "
            "and 1 degree), what was driven under is refined, the rest added")
      .text("--align", request.align, "building file or map.yaml of a floor plan in whose frame the result is written")
      .text("--out", request.out, "new folder for building.toml and map.yaml", true)
      .flag("--detections", request.detections, "take the log's detections, also where it has images")
      .output_file("--json", request.json,
                   "write all figures there: uncertainties, what was dropped, what is not closed")
      .output_file("--png", request.png, "draw it: fixtures that are not sure in red");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("survey", [&] { return run(request); });
}
