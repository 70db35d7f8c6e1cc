#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "drivers/camera/sources/frame_source.hpp"
#include "drivers/camera/sources/v4l2_device.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/common/process/clock.hpp"

namespace luminav {

/// What is asked of a webcam.
struct V4l2CameraParams {
  std::string device = "/dev/video0";  // a path below /dev/v4l/by-id stays the same when it is plugged in again
  int width = 640;                     // [px]
  int height = 480;                    // [px]
  double rate = 15.0;                  // [frames/s]
  double row_time_us = 0.0;            // [us] as believed; devices do not tell
  double max_gain = 8.0;               // gain at the top of the device's range; its bottom is taken as 1
};

/// A webcam through Video4Linux: manual exposure and gain, set and read back, and stamps of the kernel. A device that
/// is missing, busy or vanishes is looked for again with growing delays.
class V4l2Camera final : public FrameSource {
 public:
  V4l2Camera(const V4l2CameraParams& params, const Clock& clock);

  [[nodiscard]] int descriptor() const override { return device_ == nullptr ? -1 : device_->descriptor(); }
  [[nodiscard]] std::optional<std::int64_t> due() const override { return check_at_; }
  [[nodiscard]] bool take(std::int64_t now, Frame& frame) override;
  bool set_exposure(double exposure_us, double gain) override;
  [[nodiscard]] std::string fault() const override { return fault_; }
  [[nodiscard]] std::string shortcoming() const override { return shortcoming_; }
  [[nodiscard]] std::string description() const override;

 private:
  void look_for_device(std::int64_t now);
  void lose_device(std::int64_t now, const std::string& why);
  void switch_automatics_off();
  bool apply_exposure();
  [[nodiscard]] bool convert(const V4l2Buffer& buffer, GreyImage& image);
  [[nodiscard]] std::int64_t middle_of(const V4l2Buffer& buffer) const;

  V4l2CameraParams params_;
  const Clock& clock_;
  std::unique_ptr<V4l2Device> device_;
  JpegDecoder decoder_;
  std::int64_t silence_;                  // [us] without a frame until the device is opened anew
  std::optional<std::int64_t> check_at_;  // [us] look for the device, or for frames that should have come
  std::int64_t retry_delay_ = 0;          // [us]
  std::string fault_;
  std::string shortcoming_;
  bool has_wish_ = false;
  double wished_exposure_us_ = 0.0;
  double wished_gain_ = 1.0;
  double exposure_us_ = 0.0;  // read back; 0 = unknown
  double gain_ = 1.0;         // read back
  std::int64_t damaged_ = 0;
};

}  // namespace luminav
