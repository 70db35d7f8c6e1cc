// Compares a survey with the simulated world whose drive it was made of.

#include <fmt/format.h>

#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <luminav/sim_truth_t.hpp>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/evaluation/survey_score/survey_score.hpp"
#include "tests/evaluation/survey_score/written_survey.hpp"

namespace luminav {
namespace {

constexpr double kSpacing = 0.05;  // [m] between the poses of the path

struct TruePath {
  std::vector<Pose2> poses;  // some centimetres apart
  Pose2 begin;               // where the survey's first image was taken
};

TruePath true_path(const std::string& file, std::int64_t begin_utime) {
  lcm::LogFile log(file, "r");
  if (!log.good()) {
    throw std::runtime_error(file + ": cannot be read as an LCM log");
  }
  TruePath path;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    sim_truth_t truth{};
    if (event->channel == channels::kSimTruth && truth.decode(event->data, 0, event->datalen) > 0) {
      const Pose2 pose{truth.x, truth.y, truth.theta};
      if (path.poses.empty() || distance(path.poses.back(), pose) >= kSpacing) {
        path.poses.push_back(pose);
      }
      path.begin = truth.utime <= begin_utime ? pose : path.begin;
    }
  }
  if (path.poses.empty()) {
    throw std::runtime_error(file + ": has no SIM_TRUTH");
  }
  return path;
}

/// The map as it lies in another frame, at the same resolution.
PriorMap moved(const PriorMap& map, const Pose2& new_from_old) {
  const GridGeometry& old = map.geometry;
  const Eigen::Vector2d size = old.resolution * Eigen::Vector2d(old.columns, old.rows);
  Eigen::Vector2d low = new_from_old * old.origin;
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(size.x(), 0.0), Eigen::Vector2d(0.0, size.y()), size}) {
    low = low.cwiseMin(new_from_old * Eigen::Vector2d(old.origin + corner));
    high = high.cwiseMax(new_from_old * Eigen::Vector2d(old.origin + corner));
  }
  PriorMap result;
  result.geometry.resolution = old.resolution;
  result.geometry.origin = (low / old.resolution).array().floor() * old.resolution;
  const Eigen::Vector2d cells = (high - result.geometry.origin) / old.resolution;
  result.geometry.columns = static_cast<int>(std::ceil(cells.x()));
  result.geometry.rows = static_cast<int>(std::ceil(cells.y()));
  const Pose2 old_from_new = new_from_old.inverse();
  for (int row = 0; row < result.geometry.rows; ++row) {
    for (int column = 0; column < result.geometry.columns; ++column) {
      result.cells.push_back(map.at(old_from_new * result.geometry.centre_of({column, row})));
    }
  }
  return result;
}

/// Writes the survey in the frame of the building that it is of, with that one's places, for scenarios with [truth].
void write_aligned(const std::filesystem::path& folder, const WrittenFolder& written, const Building& hung,
                   const Pose2& alignment) {
  std::filesystem::create_directories(folder);
  write_map(folder / "map.yaml", moved(written.map, alignment));
  Building survey = written.building;
  for (Fixture& fixture : survey.fixtures) {
    fixture.world_from_fixture = alignment * fixture.world_from_fixture;
  }
  for (Eigen::Vector2d& place : survey.seen_from) {
    place = alignment * place;
  }
  survey.map_file = "map.yaml";
  survey.places = hung.places;
  survey.search = hung.search;
  write_building(folder / "building.toml", survey);
}

int run(const std::string& scenario_file, std::int64_t seed, const std::string& log, const std::string& survey,
        const std::string& json, const std::string& figures, const std::string& aligned) {
  Scenario scenario = read_scenario(scenario_file);
  scenario.seed = static_cast<std::uint64_t>(seed);
  const WorldTruth world =
      draw_world(scenario, read_building(scenario.true_building_file), read_robot(scenario.robot_file));
  const WrittenFolder written = read_written_survey(survey, json);
  const TruePath path = true_path(log, written.begin_utime);
  const SurveyScore score = score_survey(written.fixtures, world, path.poses, path.begin * written.begin.inverse());
  fmt::print("seed {}: {}\n", seed, to_text(score));
  if (!figures.empty()) {
    write_whole_file(figures, to_json(score));
  }
  if (!aligned.empty()) {
    write_aligned(aligned, written, world.building, score.truth_from_survey);
  }
  return 0;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  std::string scenario;
  std::string log;
  std::string survey;
  std::string json;
  std::string figures;
  std::string aligned;
  std::int64_t seed = 1;
  luminav::CommandLine line("score_survey", "Compares a survey with the simulated world whose drive it was made of.");
  line.text("--scenario", scenario, "of the drive", true)
      .integer("--seed", seed, "of the drive")
      .text("--log", log, "of the drive, with SIM_TRUTH", true)
      .text("--survey", survey, "building.toml that was made of it", true)
      .text("--json", json, "what scripts/survey --json wrote", true)
      .output_file("--figures", figures, "where the figures are written, as JSON")
      .text("--aligned", aligned, "folder for the survey in the frame of the building that it is of, with its places");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("score_survey",
                              [&] { return luminav::run(scenario, seed, log, survey, json, figures, aligned); });
}
