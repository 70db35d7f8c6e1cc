#include "drivers/camera/camera_node.hpp"

#include "services/common/process/lcm_conversions.hpp"

#include <algorithm>
#include <string>

#include "drivers/camera/truth_message.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kOdometryAge = 500'000;   // [us] older than the frame by this: the driver is gone, not turning
constexpr std::int64_t kLossShown = 10'000'000;  // [us] of frames for which a lost one is worth a word

}  // namespace

CameraNode::CameraNode(lcm::LCM& lcm, const CameraConfig& config, const Clock& clock, FrameSource& source)
    : lcm_(lcm),
      config_(config),
      clock_(clock),
      source_(source),
      exposure_(config.exposure),
      quality_(config.quality),
      subscriber_(lcm) {
  message_.camera = static_cast<std::int8_t>(config.camera_index);
  source_.set_exposure(exposure_.setting().exposure_us, exposure_.setting().gain);
  subscriber_.on(channels::kOdometry, &CameraNode::on_odometry, this);
}

CameraNode::CameraNode(lcm::LCM& lcm, const CameraConfig& config, const Clock& clock, SimulatedCeiling& source)
    : CameraNode(lcm, config, clock, static_cast<FrameSource&>(source)) {
  ceiling_ = &source;
  subscriber_.on(channels::kSimTruth, &CameraNode::on_truth, this);
}

void CameraNode::on_odometry(const odometry_t& message) {
  if (!is_possible(message)) {
    subscriber_.drop("ODOMETRY: what no robot measures");
    return;
  }
  if (odometry_stamps_.check(message.utime) == StampGuard::Verdict::kOld) {
    subscriber_.drop("ODOMETRY: old stamp");
    return;
  }
  angular_ = message.angular;
}

void CameraNode::on_truth(const sim_truth_t& message) {
  if (!all_finite({message.x, message.y, message.theta, message.roll, message.pitch, message.daylight})) {
    subscriber_.drop("SIM_TRUTH: not a number");
    return;
  }
  const bool states_known = std::all_of(message.lamp_state.begin(), message.lamp_state.end(), [](std::int8_t state) {
    return state >= sim_truth_t::LAMP_OFF && state <= sim_truth_t::LAMP_FLICKER;
  });
  if (!states_known) {
    subscriber_.drop("SIM_TRUTH: unknown state of a lamp");
    return;
  }
  if (!ceiling_->on_truth(truth_sample(message))) {
    subscriber_.drop("SIM_TRUTH: old stamp");
    return;
  }
  poll();
}

std::optional<std::int64_t> CameraNode::time_left() const {
  const std::optional<std::int64_t> due = source_.due();
  return due ? std::optional(*due - clock_.utime()) : std::nullopt;
}

void CameraNode::poll() {
  if (source_.take(clock_.utime(), frame_)) {
    pictures_.look_at(frame_.image, frame_.utime);
    if (pictures_.is_frozen()) {
      return;  // nobody shall take it for the ceiling
    }
    control_exposure(frame_);
    publish(frame_);
  }
}

void CameraNode::control_exposure(const Frame& frame) {
  if (frame.exposure_us <= 0.0) {
    return;
  }
  const bool odometry_is_fresh = odometry_stamps_.newest() > frame.utime - kOdometryAge;
  const ExposureSetting before = exposure_.setting();
  const ExposureSetting wanted =
      exposure_.update(frame.image.view(), frame.exposure_us, frame.gain, odometry_is_fresh ? angular_ : 0.0);
  if (wanted != before) {
    source_.set_exposure(wanted.exposure_us, wanted.gain);
  }
}

bool CameraNode::fill_jpeg(const GreyView& image, camera_image_t& message) {
  // From a little better than what the last one needed: noise, and with it the size, changes slowly.
  constexpr int kStep = 5;
  quality_ = std::min(config_.quality, quality_ + kStep);
  auto bytes = encoder_.encode(image, quality_);
  while (static_cast<int>(bytes.size()) > config_.max_size && quality_ > kStep) {
    quality_ -= kStep;
    bytes = encoder_.encode(image, quality_);
  }
  if (bytes.empty() || static_cast<int>(bytes.size()) > config_.max_size) {
    return false;
  }
  message.format = camera_image_t::FORMAT_JPEG;
  message.quality = static_cast<std::int8_t>(quality_);
  message.data.assign(bytes.begin(), bytes.end());
  return true;
}

void CameraNode::publish(const Frame& frame) {
  message_.utime = frame.utime;
  message_.width = frame.image.width;
  message_.height = frame.image.height;
  message_.exposure_us = exposure_.exposure_of_last(frame.exposure_us);
  message_.gain = frame.gain;
  message_.row_time_us = frame.row_time_us;
  message_.health = pictures_.is_dark() ? pictures_.complaint() : exposure_.complaint();
  if (config_.encoding == ImageEncoding::kMono8) {
    message_.format = camera_image_t::FORMAT_MONO8;
    message_.quality = 0;
    message_.data.assign(frame.image.pixels.begin(), frame.image.pixels.end());
  } else if (!fill_jpeg(frame.image.view(), message_)) {
    ++lost_frames_;
    lost_utime_ = frame.utime;
    return;
  }
  message_.size = static_cast<std::int32_t>(message_.data.size());
  lcm_.publish(channels::kCameraImage, &message_);
  ++message_.sequence;
}

bool CameraNode::has_lost_lately() const {
  const std::int64_t since =
      message_.utime - lost_utime_;  // the message has the stamp of the newest frame, sent or not
  return lost_frames_ > 0 && since >= 0 && since < kLossShown;
}

Health CameraNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  if (const std::string fault = source_.fault(); !fault.empty()) {
    health.fault = true;
    health.reason = fault;
  } else if (const std::string complaint = pictures_.complaint(); !complaint.empty()) {
    health.fault = pictures_.is_frozen();
    health.degraded = !health.fault;
    health.reason = complaint;
  } else if (const std::string shortcoming = source_.shortcoming(); !shortcoming.empty()) {
    health.degraded = true;
    health.reason = shortcoming;
  } else if (!exposure_.complaint().empty()) {
    health.degraded = true;
    health.reason = exposure_.complaint();
  } else if (has_lost_lately()) {
    health.degraded = true;
    health.reason = std::to_string(lost_frames_) + " pictures did not fit into a message";
  }
  return health;
}

}  // namespace luminav
