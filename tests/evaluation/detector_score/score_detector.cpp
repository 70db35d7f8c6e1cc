#include <fmt/format.h>
#include <time.h>

#include <stdexcept>

#include "services/common/configuration/building_file.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/detector/detector.hpp"
#include "tests/evaluation/detector_score/condition_frames.hpp"
#include "tests/evaluation/detector_score/detector_score.hpp"
#include "tests/evaluation/detector_score/frame_judgement.hpp"

namespace luminav::score {
namespace {

using simulated::Exposure;
using simulated::LampState;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The building as the detector is told it, with true heights unless it is to work with those of the file.
CeilingCatalogue catalogue_for(const DetectorScoreOptions& options, const Building& believed, const WorldTruth& world) {
  Building building = believed;
  if (!options.believed_camera) {
    building.ceiling_height = world.building.ceiling_height;
    for (std::size_t i = 0; i < believed.fixtures.size(); ++i) {
      building.fixtures[i].height = world.building.fixtures[i].height;
    }
  }
  return catalogue_of(building);
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
  simulated::CeilingRenderer renderer({.building = world.building,
                                       .intrinsics = world.robot.camera.intrinsics,
                                       .mounting = world.robot.camera.mounting,
                                       .grey_noise = world.grey_noise,
                                       .unlit_darker = world.unlit_darker,
                                       .seed = scenario.seed});
  const CeilingCamera camera(world.robot.camera.intrinsics, world.robot.camera.mounting);
  DetectorParams params;
  params.mode = options.mode;
  Detector detector(params, options.believed_camera ? robot.camera : world.robot.camera,
                    catalogue_for(options, believed, world));
  JpegEncoder encoder;
  JpegDecoder decoder;
  std::uint64_t generator_state = scenario.seed * 77 + 5;

  for (int frame = 0; frame < options.frames; ++frame) {
    const Place place = draw_place(condition, world, random, generator_state);
    renderer.set_world(place.daylight, lamps, {});
    Exposure exposure;
    exposure.number = static_cast<std::uint64_t>(frame);
    exposure.utime = 1e6 * frame + 1e6 * random.uniform();
    expose(renderer, place.motion.world_from_robot, condition.brightness, exposure);
    GreyImage image;
    render(renderer, place.motion, exposure, image);
    if (options.jpeg) {
      const auto bytes = encoder.encode(image.view(), 85);
      if (!decoder.decode(bytes, image)) {
        throw std::runtime_error("detector score: a JPEG of ours cannot be read");
      }
    }
    std::vector<VisibleFixture> visible;
    for (std::size_t i = 0; i < world.building.fixtures.size(); ++i) {
      const Fixture& fixture = world.building.fixtures[i];
      if (const auto imaged = image_of(fixture, place.motion, camera)) {
        visible.push_back({*imaged, &fixture, lamps[i], false});
      }
    }
    const double before = thread_seconds();
    DetectorTrace trace;
    std::vector<Detection> detections = detector.detect(image.view(), listener ? &trace : nullptr);
    score.seconds += thread_seconds() - before;
    ++score.frames;
    std::vector<std::string> complaints = judge(detections, visible, score);
    count_elements(world, place.motion, camera, detections, score);
    if (listener) {
      listener({fmt::format("{}_{}_{}", condition.name, scenario.seed, frame), &image, std::move(detections),
                std::move(complaints), std::move(trace)});
    }
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
