#include "drivers/camera/simulated/ceiling.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

using simulated::LampState;
using simulated::TruePose;
using simulated::TruthSample;

simulated::CeilingModel model_of(const WorldTruth& truth, std::uint64_t seed) {
  simulated::CeilingModel model;
  model.building = truth.building;
  model.intrinsics = truth.robot.camera.intrinsics;
  model.mounting = truth.robot.camera.mounting;
  model.grey_noise = truth.grey_noise;
  model.unlit_darker = truth.unlit_darker;
  model.luminaires = truth.luminaires;
  model.seed = seed;
  return model;
}

std::vector<LampState> states_of(const std::vector<std::int8_t>& lamps) {
  std::vector<LampState> states;
  states.reserve(lamps.size());
  for (const std::int8_t lamp : lamps) {
    states.push_back(lamp >= 0 && lamp <= 3 ? static_cast<LampState>(lamp) : LampState::kOn);
  }
  return states;
}

}  // namespace

SimulatedCeiling::SimulatedCeiling(const WorldTruth& truth, std::uint64_t seed, const SimulatedCeilingParams& params)
    : params_(params),
      row_time_us_(truth.robot.camera.row_time * 1e6),
      time_offset_us_(truth.robot.camera.time_offset * 1e6),
      renderer_(model_of(truth, seed)),
      setting_{0, params.exposure_us, params.gain} {
  renderer_.set_world(truth.daylight, states_of(truth.lamp_states), {});
  std::copy_if(truth.events.begin(), truth.events.end(), std::back_inserter(events_), [](const ScenarioEvent& event) {
    return event.kind == EventKind::kCover || (event.kind == EventKind::kFreeze && event.device == "camera");
  });
}

bool SimulatedCeiling::is_under_way(EventKind kind, const TruthSample& now) const {
  const double time = seconds_between(now.session, now.utime);
  return std::any_of(events_.begin(), events_.end(), [&](const ScenarioEvent& event) {
    return event.kind == kind && time >= event.at && time < event.at + event.duration;
  });
}

bool SimulatedCeiling::on_truth(const TruthSample& sample) {
  const bool restarted = !truth_.empty() && truth_.newest().session != sample.session;
  if (!truth_.add(sample)) {
    return false;
  }
  unplugged_ = sample.camera_unplugged;
  if (restarted || unplugged_) {
    running_ = false;
    arrives_.reset();
  } else if (!running_) {
    // Plugged in: the first frame is one for which the truth before it will be known too.
    start_frames_at(static_cast<double>(sample.utime) + 0.5 * row_time_us_ * renderer_.height() + 50'000.0);
  }
  return true;
}

double SimulatedCeiling::next_middle() const {
  return first_middle_ + std::round(static_cast<double>(number_ - first_number_) * 1e6 / params_.rate);
}

void SimulatedCeiling::start_frames_at(double middle) {
  running_ = true;
  first_middle_ = std::round(middle);
  first_number_ = number_;
}

void SimulatedCeiling::apply_settings() {
  while (!asked_.empty() && asked_.front().from_frame <= number_) {
    setting_ = asked_.front();
    asked_.pop_front();
  }
}

std::optional<std::int64_t> SimulatedCeiling::due() const {
  return arrives_;
}

void SimulatedCeiling::expose_next() {
  const auto is_known = [&] { return next_middle() + half_shown() <= static_cast<double>(truth_.newest().utime); };
  while (running_ && !arrives_ && is_known()) {
    apply_settings();
    if (render_next(exposed_)) {
      arrives_ = std::llround(next_middle() + 0.5 * row_time_us_ * renderer_.height() + 0.5 * setting_.exposure_us +
                              params_.transfer_time * 1e6);
    }
    ++number_;
  }
}

bool SimulatedCeiling::take(std::int64_t now, Frame& frame) {
  bool taken = false;
  for (expose_next(); arrives_ && std::max(now, truth_.newest().utime) >= *arrives_; expose_next()) {
    std::swap(frame, exposed_);
    arrives_.reset();
    taken = true;
  }
  return taken;
}

double SimulatedCeiling::half_shown() const {
  return std::max(5'000.0, 0.5 * row_time_us_ * (renderer_.height() - 1));
}

bool SimulatedCeiling::render_next(Frame& frame) {
  const double middle = next_middle();
  const int height = renderer_.height();
  rows_.clear();
  for (int row = 0; row < height; ++row) {
    const auto pose = truth_.at(middle + (row - 0.5 * (height - 1)) * row_time_us_);
    if (!pose) {  // the truth came too late for it: the frame is lost
      return false;
    }
    rows_.push_back(*pose);
  }
  // The robot's motion for the blur.
  const double half = half_shown();
  const auto before = truth_.at(middle - half);
  const auto after = truth_.at(middle + half);
  simulated::Exposure exposure;
  exposure.number = number_;
  exposure.utime = middle;
  exposure.exposure_us = setting_.exposure_us;
  exposure.gain = setting_.gain;
  exposure.row_time_us = row_time_us_;
  if (before && after) {
    const Eigen::Vector2d step = after->world_from_robot.position() - before->world_from_robot.position();
    const double seconds = 2e-6 * half;
    exposure.velocity = step / seconds;
    exposure.angular = wrap_angle(after->world_from_robot.theta - before->world_from_robot.theta) / seconds;
  }
  const TruthSample& now = truth_.from(middle + half);
  renderer_.set_world(now.daylight, now.lamps, now.moved);
  if (is_under_way(EventKind::kFreeze, now) && !last_.pixels.empty()) {
    frame.image = last_;
  } else {
    renderer_.render(exposure, rows_, frame.image);
  }
  if (is_under_way(EventKind::kCover, now)) {
    constexpr std::uint8_t kLeft = 64;  // a little noise comes through
    std::for_each(frame.image.pixels.begin(), frame.image.pixels.end(), [](std::uint8_t& pixel) { pixel /= kLeft; });
  }
  if (!events_.empty()) {
    last_ = frame.image;
  }
  frame.utime = std::llround(middle - time_offset_us_);
  frame.exposure_us = setting_.exposure_us;
  frame.gain = setting_.gain;
  frame.row_time_us = row_time_us_;
  return true;
}

bool SimulatedCeiling::set_exposure(double exposure_us, double gain) {
  const std::uint64_t from = number_ + static_cast<std::uint64_t>(std::max(0, params_.setting_delay - 1));
  asked_.push_back({from, exposure_us, gain});
  return true;
}

std::string SimulatedCeiling::fault() const {
  if (unplugged_) {
    return "the camera is unplugged";
  }
  return truth_.empty() ? "waiting for SIM_TRUTH of the simulator" : "";
}

std::string SimulatedCeiling::description() const {
  const auto& lens = renderer_.model().intrinsics;
  return "simulated ceiling, " + std::to_string(lens.width) + " x " + std::to_string(lens.height) + ", seed " +
         std::to_string(renderer_.model().seed);
}

void SimulatedCeiling::render_still(const Pose2& world_from_robot, double exposure_us, double gain, GreyImage& image) {
  simulated::Exposure exposure;
  exposure.exposure_us = exposure_us;
  exposure.gain = gain;
  const TruePose pose{world_from_robot, 0.0, 0.0};
  renderer_.render(exposure, std::span(&pose, 1), image);
}

}  // namespace luminav
