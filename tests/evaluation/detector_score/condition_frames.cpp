#include "tests/evaluation/detector_score/condition_frames.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/camera/exposure_control.hpp"

namespace luminav::score {

using Eigen::Vector2d;
using simulated::Exposure;
using simulated::LampState;
using simulated::TruePose;

const std::vector<Condition>& lighting_matrix() {
  static const std::vector<Condition> matrix{
      {.name = "all on", .lamps_on = true},
      {.name = "all on, moving", .lamps_on = true, .moving = true},
      {.name = "all on at night", .lamps_on = true, .min_daylight = 0.0, .max_daylight = 0.0},
      {.name = "third off", .off = 0.33},
      {.name = "third off, moving", .off = 0.33, .moving = true},
      {.name = "all off by day", .min_daylight = 0.8, .max_daylight = 0.8, .off = 1.0},
      {.name = "off by day, moving", .min_daylight = 0.8, .max_daylight = 0.8, .off = 1.0, .moving = true},
      {.name = "half tubes", .half = 0.5},
      {.name = "flicker", .off = 0.2, .flicker = 0.3},
      {.name = "sunrise sweep", .min_daylight = 0.05, .max_daylight = 1.0, .off = 0.5},
      {.name = "window glare", .min_daylight = 1.0, .max_daylight = 1.0, .off = 0.3, .at_window = true},
      {.name = "dim", .min_daylight = 0.1, .max_daylight = 0.1, .off = 0.6, .brightness = 0.45},
      {.name = "bright", .off = 0.2, .brightness = 1.25},
  };
  return matrix;
}

std::vector<LampState> draw_lamps(const Condition& condition, std::size_t count, RandomStream& random) {
  std::vector<LampState> lamps(count, LampState::kOn);
  for (LampState& lamp : lamps) {
    const double draw = random.uniform();
    lamp = draw < condition.off                                        ? LampState::kOff
           : draw < condition.off + condition.half                     ? LampState::kHalf
           : draw < condition.off + condition.half + condition.flicker ? LampState::kFlicker
                                                                       : LampState::kOn;
  }
  return lamps;
}

void expose(simulated::CeilingRenderer& renderer, const Pose2& pose, double factor, Exposure& exposure) {
  const std::vector<TruePose> still{{pose, 0.0, 0.0}};
  const ExposureParams params;
  GreyImage image;
  double product = 8000.0;  // exposure x gain
  const auto set = [&] {
    exposure.exposure_us = std::min(product, params.max_exposure_us);
    exposure.gain = std::clamp(product / params.max_exposure_us, 1.0, params.max_gain);
  };
  const double max = params.max_exposure_us * params.max_gain;
  for (int i = 0; i < 6; ++i) {
    set();
    renderer.render(exposure, still, image);
    const double mean = measure_brightness(image.view(), params.lamp_grey).mean;
    if (mean > params.min_target && mean < params.max_target) {
      break;
    }
    product = std::clamp(product * std::clamp(100.0 / std::max(mean, 1.0), 0.2, 5.0), params.min_exposure_us, max);
  }
  product = std::clamp(product * factor, params.min_exposure_us, max);
  set();
}

Place draw_place(const Condition& condition, const WorldTruth& world, RandomStream& random, SplitMix& generator) {
  Place place;
  Pose2& pose = place.motion.world_from_robot;
  if (condition.at_window && !world.building.windows.empty()) {
    const Window& window = world.building.windows[random.below(world.building.windows.size())];
    pose = window.world_from_window * Pose2{random.uniform(0.6, 2.0), random.uniform(-1.0, 1.0), 0.0};
  } else {
    const Vector2d point = draw_free_point(world.walls, 0.3, generator);
    pose = {point.x(), point.y(), 0.0};
  }
  pose.theta = random.uniform(-kPi, kPi);
  if (condition.moving) {
    place.motion.velocity = {random.uniform(-0.35, 0.35), random.uniform(-0.35, 0.35)};
    place.motion.angular = random.uniform(-0.5, 0.5);
    place.motion.row_time = world.robot.camera.row_time;
  }
  place.daylight = random.uniform(condition.min_daylight, condition.max_daylight);
  return place;
}

void render(simulated::CeilingRenderer& renderer, const FrameMotion& motion, Exposure& exposure, GreyImage& image) {
  exposure.velocity = motion.velocity;
  exposure.angular = motion.angular;
  exposure.row_time_us = 1e6 * motion.row_time;
  std::vector<TruePose> rows;
  for (int row = 0; row < renderer.height(); ++row) {
    rows.push_back({motion.world_from_robot_at(row, renderer.height()), 0.0, 0.0});
  }
  renderer.render(exposure, rows, image);
}

}  // namespace luminav::score
