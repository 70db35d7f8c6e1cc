#include <fmt/format.h>
#include "services/common/configuration/building_file.hpp"
#include "tests/evaluation/detector_score/condition_frames.hpp"
#include "tests/evaluation/detector_score/detector_score.hpp"
#include "tests/evaluation/detector_score/score_stage.hpp"

namespace luminav::score {
namespace {

using simulated::Exposure;
using simulated::LampState;

/// The building as the detector is told it, with true heights unless it is to work with those of the file.
Building told_building(const DetectorScoreOptions& options, const Building& believed, const WorldTruth& world) {
  Building building = believed;
  if (!options.believed_camera) {
    building.ceiling_height = world.building.ceiling_height;
    for (std::size_t i = 0; i < believed.fixtures.size(); ++i) {
      building.fixtures[i].height = world.building.fixtures[i].height;
    }
  }
  return building;
}

void score_world(const DetectorScoreOptions& options, const Condition& condition, int world_index,
                 const FrameListener& listener, DetectorScore& score) {
  Scenario scenario = read_scenario(options.scenario);
  scenario.seed = options.first_seed + static_cast<std::uint64_t>(world_index);
  scenario.world.calibrated = true;
  const Building believed = read_building(scenario.building_file);
  const RobotDescription robot = read_robot(scenario.robot_file);
  const WorldTruth world = draw_world(scenario, believed, robot);
  RandomStream random(scenario.seed, "detector_score " + condition.name);
  const std::vector<LampState> lamps = draw_lamps(condition, world.building.fixtures.size(), random);
  DetectorParams params;
  params.mode = options.mode;
  ScoreStage stage({.building = world.building,
                    .intrinsics = world.robot.camera.intrinsics,
                    .mounting = world.robot.camera.mounting,
                    .grey_noise = world.grey_noise,
                    .unlit_darker = world.unlit_darker,
                    .luminaires = world.luminaires,
                    .clutter = {},
                    .seed = scenario.seed},
                   params, options.believed_camera ? robot.camera : world.robot.camera,
                   told_building(options, believed, world), lamps);
  SplitMix generator(scenario.seed * 77 + 5);
  for (int frame = 0; frame < options.frames; ++frame) {
    const Place place = draw_place(condition, world, random, generator);
    Exposure exposure;
    exposure.number = static_cast<std::uint64_t>(frame);
    exposure.utime = 1e6 * frame + 1e6 * random.uniform();
    stage.score_frame(fmt::format("{}_{}_{}", condition.name, scenario.seed, frame), place, condition.brightness,
                      exposure, options.jpeg, listener, score);
  }
}

}  // namespace

DetectorScore score_detector(const DetectorScoreOptions& options, const Condition& condition,
                             const FrameListener& listener) {
  DetectorScore score;
  for (int world = 0; world < options.worlds; ++world) {
    score_world(options, condition, world, listener, score);
  }
  return score;
}

}  // namespace luminav::score
