#include "drivers/camera/sources/v4l2_camera.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "drivers/camera/sources/pixel_formats.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kFirstDelay = 500'000;      // [us] before looking for a device again
constexpr std::int64_t kLongestDelay = 8'000'000;  // [us]
// Without a frame for so long a webcam hangs, and comes back when reopened.
constexpr double kSilence = 2.0;           // [s] at least
constexpr double kSilentFrames = 4.0;      // periods at least
constexpr double kExposureUnitUs = 100.0;  // of V4L2_CID_EXPOSURE_ABSOLUTE

int rounded_into(const V4l2Range& range, double value) {
  const double steps = std::round((value - range.min) / range.step);
  return std::clamp(range.min + static_cast<int>(std::clamp(steps, 0.0, 1e9)) * range.step, range.min, range.max);
}

}  // namespace

V4l2Camera::V4l2Camera(const V4l2CameraParams& params, const Clock& clock)
    : params_(params), clock_(clock), silence_(std::llround(1e6 * std::max(kSilence, kSilentFrames / params.rate))) {
  look_for_device(clock.utime());
}

void V4l2Camera::look_for_device(std::int64_t now) {
  try {
    device_ = std::make_unique<V4l2Device>(params_.device, params_.width, params_.height, params_.rate);
  } catch (const std::runtime_error& error) {
    lose_device(now, error.what());
    return;
  }
  fault_.clear();
  shortcoming_.clear();
  check_at_ = now + silence_;
  const V4l2Format& format = device_->format();
  if (format.width != params_.width || format.height != params_.height) {
    shortcoming_ = params_.device + " gives " + std::to_string(format.width) + " x " + std::to_string(format.height) +
                   " pixels, not " + std::to_string(params_.width) + " x " + std::to_string(params_.height);
  }
  switch_automatics_off();
  if (has_wish_) {
    apply_exposure();
  }
}

void V4l2Camera::lose_device(std::int64_t now, const std::string& why) {
  device_.reset();
  fault_ = why;
  exposure_us_ = 0.0;
  retry_delay_ = std::clamp(2 * retry_delay_, kFirstDelay, kLongestDelay);
  check_at_ = now + retry_delay_;
}

void V4l2Camera::switch_automatics_off() {
  if (device_->set(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL) != V4L2_EXPOSURE_MANUAL) {
    shortcoming_ +=
        (shortcoming_.empty() ? "" : "; ") + params_.device + " has no manual exposure: its own control is at work";
  }
  device_->set(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0);  // it would lower the rate in the dark
  device_->set(V4L2_CID_AUTOGAIN, 0);
}

bool V4l2Camera::set_exposure(double exposure_us, double gain) {
  has_wish_ = true;
  wished_exposure_us_ = exposure_us;
  wished_gain_ = gain;
  return device_ == nullptr || apply_exposure();
}

bool V4l2Camera::apply_exposure() {
  const auto exposures = device_->range_of(V4L2_CID_EXPOSURE_ABSOLUTE);
  if (!exposures) {
    return false;
  }
  const auto exposure =
      device_->set(V4L2_CID_EXPOSURE_ABSOLUTE, rounded_into(*exposures, wished_exposure_us_ / kExposureUnitUs));
  if (!exposure) {
    return false;
  }
  exposure_us_ = *exposure * kExposureUnitUs;
  // Devices count gain in units of their own: taken as linear from 1 at the bottom of the range.
  if (const auto gains = device_->range_of(V4L2_CID_GAIN); gains && gains->max > gains->min) {
    const double per_unit = (params_.max_gain - 1.0) / (gains->max - gains->min);
    const auto gain = device_->set(V4L2_CID_GAIN, rounded_into(*gains, gains->min + (wished_gain_ - 1.0) / per_unit));
    gain_ = gain ? 1.0 + (*gain - gains->min) * per_unit : 1.0;
  }
  return true;
}

std::int64_t V4l2Camera::middle_of(const V4l2Buffer& buffer) const {
  const std::int64_t now = clock_.utime();
  const std::int64_t age = buffer.stamp_is_monotonic
                               ? std::clamp<std::int64_t>(read_clock(CLOCK_MONOTONIC) - buffer.stamp, 0, 1'000'000)
                               : 0;
  const double readout = params_.row_time_us * device_->format().height;
  const double half = 0.5 * (readout + exposure_us_);
  return now - age + std::llround(buffer.stamp_is_monotonic && buffer.stamp_is_start ? half : -half);
}

bool V4l2Camera::convert(const V4l2Buffer& buffer, GreyImage& image) {
  const V4l2Format& format = device_->format();
  if (format.pixel_format == V4L2_PIX_FMT_MJPEG) {
    return decoder_.decode(buffer.bytes, image);
  }
  image.width = format.width;
  image.height = format.height;
  return format.pixel_format == V4L2_PIX_FMT_YUYV ? luma_from_yuyv(buffer.bytes, format.stride, image)
                                                  : luma_from_grey(buffer.bytes, format.stride, image);
}

bool V4l2Camera::take(std::int64_t now, Frame& frame) {
  if (device_ == nullptr) {
    if (now >= check_at_.value_or(now)) {
      look_for_device(now);
    }
    return false;
  }
  bool taken = false;
  try {
    std::optional<V4l2Buffer> newest;
    while (auto buffer = device_->take()) {
      if (newest) {
        device_->give_back(*newest);
      }
      newest = buffer;
    }
    if (newest) {
      taken = !newest->damaged && convert(*newest, frame.image);
      damaged_ += taken ? 0 : 1;
      frame.utime = middle_of(*newest);
      device_->give_back(*newest);
    }
  } catch (const std::runtime_error& error) {
    lose_device(now, error.what());
    return false;
  }
  if (taken) {
    frame.exposure_us = exposure_us_;
    frame.gain = gain_;
    frame.row_time_us = params_.row_time_us;
    retry_delay_ = 0;
    check_at_ = now + silence_;
  } else if (now >= check_at_.value_or(now)) {
    lose_device(now, params_.device + ": no whole picture for " + std::to_string(silence_ / 1'000'000) + " s");
  }
  return taken;
}

std::string V4l2Camera::description() const {
  if (device_ == nullptr) {
    return fault_;
  }
  const V4l2Format& format = device_->format();
  std::string code;
  for (int shift = 0; shift < 32; shift += 8) {
    code += static_cast<char>((format.pixel_format >> static_cast<unsigned>(shift)) & 0x7FU);
  }
  return device_->name() + " at " + params_.device + ", " + std::to_string(format.width) + " x " +
         std::to_string(format.height) + " " + code;
}

}  // namespace luminav
