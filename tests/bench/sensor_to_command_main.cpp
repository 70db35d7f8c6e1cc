// From the middle of a picture's exposure to what follows from it, read from a recorded drive.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "drivers/camera/simulated/ceiling.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "tests/replay/log_reading/picture_trace.hpp"

namespace {

using namespace luminav;

/// When the simulated camera of a run hands a picture to its driver.
PictureTrace::Arrival arrival_in(const std::string& scenario_file, std::int64_t seed) {
  Scenario scenario = read_scenario(scenario_file);
  scenario.seed = seed < 0 ? scenario.seed : static_cast<std::uint64_t>(seed);
  const WorldTruth world =
      draw_world(scenario, read_building(scenario.true_building_file), read_robot(scenario.robot_file));
  return [time_offset = world.robot.camera.time_offset](const camera_image_t& image) {
    return image.utime + std::llround(1e6 * (time_offset + SimulatedCeilingParams{}.transfer_time) +
                                      0.5 * (image.row_time_us * image.height + image.exposure_us));
  };
}

PictureTrace follow(const std::string& file, PictureTrace::Arrival arrival) {
  LogReader log(file);
  PictureTrace trace(std::move(arrival));
  LogEvent event;
  while (log.next(event)) {
    trace.add(event);
  }
  return trace;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  std::string out;
  std::string scenario;
  std::int64_t seed = -1;
  CommandLine line("sensor_to_command", "Latency from a picture to the velocity command that used it, by stages.");
  line.positional("log", files, "recorded by demo --log", true)
      .text("--scenario", scenario, "of the demo: tells when the simulated camera's driver had a picture")
      .integer("--seed", seed, "of the demo, instead of the scenario's")
      .output_file("--json", out, "write it as a benchmark does");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("sensor_to_command", [&] {
    const PictureTrace trace =
        follow(files.front(), scenario.empty() ? PictureTrace::Arrival{} : arrival_in(scenario, seed));
    nlohmann::ordered_json json = {{"context", nlohmann::ordered_json::object()},
                                   {"benchmarks", nlohmann::ordered_json::array()}};
    bool has_command = false;
    for (const PictureTrace::Stage& stage : trace.stages()) {
      has_command = has_command || stage.name == "image_to_command";
      json["benchmarks"].push_back({{"name", fmt::format("{}/real_time", stage.name)},
                                    {"real_time", 1e3 * stage.quantile(0.5)},
                                    {"time_unit", "ms"},
                                    {"p50_ms", 1e3 * stage.quantile(0.5)},
                                    {"p99_ms", 1e3 * stage.quantile(0.99)}});
    }
    if (!has_command) {
      throw std::runtime_error(fmt::format("{}: no command in it used a picture", files.front()));
    }
    fmt::print("{}", trace.text());
    if (!out.empty()) {
      write_whole_file(out, json.dump(2) + "\n");
    }
    return 0;
  });
}
