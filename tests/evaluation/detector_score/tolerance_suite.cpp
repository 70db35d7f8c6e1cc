#include "tests/evaluation/detector_score/tolerance_suite.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>

#include "drivers/camera/exposure_control.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/detector/detector.hpp"
#include "tests/evaluation/detector_score/condition_frames.hpp"
#include "tests/evaluation/detector_score/frame_judgement.hpp"
#include "tests/evaluation/detector_score/visible_outline.hpp"

namespace luminav::score {
namespace {

using Eigen::Vector2d;
using simulated::Exposure;

constexpr double kMinShare = 0.3;             // of a fixture that must be in the image to be wanted
constexpr double kMaxHeading = radians(6.0);  // told tilt turns outlines
constexpr double kMargin = 0.02;              // [m] beyond the outline where the middle of what was found may lie

Detector detector_told(const Mistake& mistake, const WorldTruth& world, const Building& believed) {
  CameraDescription camera = world.robot.camera;
  camera.intrinsics.fx *= mistake.focal;
  camera.intrinsics.fy *= mistake.focal;
  camera.mounting.pitch += mistake.pitch;
  camera.mounting.roll += mistake.roll;
  Building building = believed;
  building.ceiling_height = mistake.height * world.building.ceiling_height;
  for (std::size_t i = 0; i < building.fixtures.size(); ++i) {
    Fixture& fixture = building.fixtures[i];
    fixture.length *= mistake.size;
    fixture.width *= mistake.size;
    fixture.height = mistake.height * world.building.fixtures[i].height + mistake.lower;
  }
  building.ceiling_height += mistake.lower;
  return Detector({}, camera, catalogue_of(building));
}

Exposure changed(const Exposure& usual, double factor) {
  const ExposureParams params;
  const double product = std::max(usual.exposure_us * usual.gain * factor, params.min_exposure_us);
  Exposure exposure = usual;
  exposure.exposure_us = std::min(product, params.max_exposure_us);
  exposure.gain = std::clamp(product / params.max_exposure_us, 1.0, params.max_gain);
  return exposure;
}

bool lies_on(const Detection& detection, const VisibleFixture& truth, const CeilingCamera& camera) {
  const auto& corners = detection.corners_px;
  const Vector2d middle_px = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const auto middle = camera.point_on_ceiling(middle_px, truth.fixture->height);
  if (!middle) {
    return false;
  }
  const Pose2& imaged = truth.imaged.as_imaged;
  const Vector2d inside = imaged.inverse() * *middle;
  const double heading =
      wrap_modulo(detection.robot_from_fixture.theta - imaged.theta, symmetry_period(truth.fixture->shape));
  return std::abs(inside.x()) < 0.5 * truth.fixture->length + kMargin &&
         std::abs(inside.y()) < 0.5 * truth.fixture->width + kMargin &&
         (!detection.has_theta || std::abs(heading) < kMaxHeading);
}

void count(const std::vector<Detection>& detections, std::vector<VisibleFixture> visible, const CeilingCamera& camera,
           DetectorScore& score) {
  ++score.frames;
  for (const VisibleFixture& fixture : visible) {
    score.visible += fixture.imaged.share >= kMinShare ? 1 : 0;
    score.plain += fixture.is_plain && fixture.imaged.share >= kMinShare ? 1 : 0;
    score.whole += fixture.imaged.is_whole ? 1 : 0;
  }
  for (const Detection& detection : detections) {
    ++score.reported;
    const auto hit = std::find_if(visible.begin(), visible.end(), [&](const VisibleFixture& truth) {
      return !truth.taken && lies_on(detection, truth, camera);
    });
    if (hit == visible.end()) {
      ++score.wrong;
      continue;
    }
    hit->taken = true;
    score.seen += hit->imaged.share >= kMinShare ? 1 : 0;
    score.plain_seen += hit->is_plain && hit->imaged.share >= kMinShare ? 1 : 0;
    score.whole_seen += hit->imaged.is_whole ? 1 : 0;
  }
}

GreyImage as_sent(const GreyImage& image) {
  static thread_local JpegEncoder encoder;
  static thread_local JpegDecoder decoder;
  GreyImage decoded;
  if (!decoder.decode(encoder.encode(image.view(), 85), decoded)) {
    throw std::runtime_error("detector score: a JPEG of ours cannot be read");
  }
  return decoded;
}

void score_world(const DetectorScoreOptions& options, int world_index, std::vector<DetectorScore>& scores) {
  Scenario scenario = read_scenario(options.scenario);
  scenario.seed = options.first_seed + static_cast<std::uint64_t>(world_index);
  scenario.world.calibrated = true;
  const Building believed = read_building(scenario.building_file);
  const WorldTruth world = draw_world(scenario, believed, read_robot(scenario.robot_file));
  const Condition condition{.name = "tolerance", .off = 0.33};
  RandomStream random(scenario.seed, "tolerance");
  const auto lamps = draw_lamps(condition, world.building.fixtures.size(), random);
  simulated::CeilingRenderer renderer({.building = world.building,
                                       .intrinsics = world.robot.camera.intrinsics,
                                       .mounting = world.robot.camera.mounting,
                                       .grey_noise = world.grey_noise,
                                       .unlit_darker = world.unlit_darker,
                                       .luminaires = world.luminaires,
                                       .clutter = {},
                                       .seed = scenario.seed});
  const CeilingCamera camera(world.robot.camera.intrinsics, world.robot.camera.mounting);
  std::deque<Detector> detectors;
  for (const Mistake& mistake : mistakes()) {
    detectors.push_back(detector_told(mistake, world, believed));
  }
  SplitMix generator(scenario.seed * 77 + 5);
  for (int frame = 0; frame < options.frames; ++frame) {
    const Place place = draw_place(condition, world, random, generator);
    renderer.set_world(place.daylight, lamps, {});
    Exposure usual{.number = static_cast<std::uint64_t>(frame), .utime = 1e6 * frame};
    expose(renderer, place.motion.world_from_robot, 1.0, usual);
    std::vector<VisibleFixture> visible;
    for (std::size_t i = 0; i < world.building.fixtures.size(); ++i) {
      if (const auto imaged = image_of(world.building.fixtures[i], place.motion, camera)) {
        visible.push_back({*imaged, &world.building.fixtures[i], lamps[i], false, false});
      }
    }
    GreyImage sent;
    double exposed = 0.0;
    for (std::size_t i = 0; i < mistakes().size(); ++i) {
      if (mistakes()[i].exposure != exposed) {
        exposed = mistakes()[i].exposure;
        Exposure exposure = changed(usual, exposed);
        GreyImage image;
        render(renderer, place.motion, exposure, image);
        sent = as_sent(image);
        for (VisibleFixture& fixture : visible) {
          fixture.is_plain = seen_share(sent.view(), camera, *fixture.fixture, fixture.imaged.as_imaged) >= kSeenShare;
        }
      }
      count(detectors[i].detect(sent.view()), visible, camera, scores[i]);
    }
  }
}

}  // namespace

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> all{
      {.name = "none"},
      {.name = "sizes 10 % too large", .size = 1.10},
      {.name = "sizes 10 % too small", .size = 0.90},
      {.name = "ceiling 5 % too high", .height = 1.05},
      {.name = "ceiling 5 % too low", .height = 0.95},
      {.name = "pitch off by 4 degrees", .pitch = radians(4.0)},
      {.name = "roll off by 4 degrees", .roll = radians(4.0)},
      {.name = "focal length 3 % too long", .focal = 1.03},
      {.name = "focal length 3 % too short", .focal = 0.97},
      {.name = "fixtures 0.4 m lower", .lower = 0.4},
      {.name = "exposure 1/4", .exposure = 0.25},
      {.name = "exposure 1/2", .exposure = 0.5},
      {.name = "exposure 2", .exposure = 2.0},
      {.name = "exposure 4", .exposure = 4.0},
  };
  return all;
}

std::vector<DetectorScore> score_mistakes(const DetectorScoreOptions& options) {
  std::vector<DetectorScore> scores(mistakes().size());
  for (int world = 0; world < options.worlds; ++world) {
    score_world(options, world, scores);
  }
  return scores;
}

}  // namespace luminav::score
