// Surveys the recording and says what grid its lights hang in, beside the author's notes.

#include <fmt/format.h>

#include <string>

#include "services/common/geometry/angle.hpp"
#include "services/common/process/command_line.hpp"
#include "services/surveyor/building_drawing.hpp"
#include "services/surveyor/drive/survey_report.hpp"
#include "tests/unit/recorded_ceiling/recorded_survey.hpp"

namespace {

using namespace luminav;

constexpr double kFoot = 0.3048;  // [m]

void print_pitch(const char* name, double pitch, double noted) {
  fmt::print("pitch {} the fixtures: {:.3f} m, by the notes {:.3f} m: {:+.2f} %\n", name, pitch, noted,
             100.0 * (pitch / noted - 1.0));
}

int run(const std::string& robot, const std::string& png) {
  const testing::RecordedSurvey recorded = testing::survey_recording(robot);
  const Survey& survey = recorded.survey;
  const testing::LightGrid& grid = recorded.grid;
  fmt::print("{:.1f} m in {} key frames, {:.1f} m left out; increments known to {:.3f} m and {:.2f} degrees at 1 m\n",
             survey.distance, survey.frames.size(), survey.left_out, recorded.model.errors.odometry_position,
             degrees(recorded.model.errors.odometry_heading));
  fmt::print(
      "{} fixtures at {} crossings of the grid, {:.3f} m and {:.2f} degrees around it (RMS); {} passes dropped\n",
      survey.fixtures.size(), grid.crossings, grid.spread, degrees(grid.turn_spread), survey.dropped.size());
  print_pitch("across", grid.pitch.x(), 10.0 * kFoot);
  print_pitch("along", grid.pitch.y(), 12.0 * kFoot);
  fmt::print("rows {:.2f} degrees apart, by the notes 90; fixtures {:.2f} degrees from their rows, by the notes 0\n",
             degrees(std::abs(grid.angle)), degrees(grid.turn));
  if (!png.empty()) {
    draw_building_png(png, building_of(survey, {}, recorded.model, "recorded hall"), nullptr,
                      unsure_fixtures(survey, recorded.model));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string robot = "fisheye-published.toml";
  std::string png;
  CommandLine line("survey_recording", "Surveys the recorded drive below office lights, without a reference pose.");
  line.text("--robot", robot, "file beside the recording that describes its camera")
      .output_file("--png", png, "where the plan is drawn");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("survey_recording", [&] { return run(robot, png); });
}
