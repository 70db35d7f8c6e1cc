// Lets the simulated robot explore a building by itself, and compares the survey with the building.

#include <fmt/format.h>

#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/surveyor/drive/survey_writing.hpp"
#include "tests/evaluation/runs/evaluation_jobs.hpp"
#include "tests/evaluation/sensing/detector_behaviour.hpp"
#include "tests/evaluation/survey_score/exploring_run.hpp"

int main(int argc, char** argv) {
  std::string scenario_file;
  std::string kinds;
  std::string out;
  std::string sensing = "geometric";
  std::string figures;
  std::string png;
  std::int64_t seed = 1;
  bool trace = false;
  luminav::CommandLine line("explore",
                            "Lets the simulated robot explore and survey a building by itself, and judges it.");
  line.text("--scenario", scenario_file, "whose building is explored; its goals do not count", true)
      .integer("--seed", seed, "of the run")
      .text("--kinds", kinds, "file of kinds", true)
      .text("--out", out, "folder of the survey", true)
      .text("--sensing", sensing, "geometric or rendered")
      .output_file("--figures", figures, "where the figures are written, as JSON")
      .output_file("--png", png, "where a picture of the run is written")
      .flag("--trace", trace, "a line every ten simulated seconds");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("explore", [&] {
    luminav::refuse_a_building_in(out);
    luminav::Scenario scenario = luminav::read_scenario(scenario_file);
    scenario.seed = static_cast<std::uint64_t>(seed);
    const luminav::DetectorBehaviour behaviour =
        luminav::read_detector_behaviour(luminav::default_behaviour_file("modern"));
    luminav::ExploringOptions options;
    options.robot.geometric = sensing == "geometric" ? &behaviour : nullptr;
    options.robot.survey_folder = out;
    options.robot.kinds_file = kinds;
    options.picture_file = png;
    options.trace = trace;
    const luminav::ExploringResult result = luminav::run_exploring(scenario, options);
    fmt::print("seed {}: {}\n", seed, luminav::to_text(result));
    if (!figures.empty()) {
      luminav::write_whole_file(figures, luminav::to_json(result));
    }
    return 0;
  });
}
