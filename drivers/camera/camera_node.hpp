#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/camera_config.hpp"
#include "drivers/camera/exposure_turns.hpp"
#include "drivers/camera/picture_watch.hpp"
#include "drivers/camera/simulated/ceiling.hpp"
#include "drivers/camera/sources/frame_source.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/stamp_guard.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// Takes frames from a source, controls its exposure and publishes CAMERA_IMAGE. Stamps and rate are the source's.
class CameraNode {
 public:
  CameraNode(lcm::LCM& lcm, const CameraConfig& config, const Clock& clock, FrameSource& source);
  /// Feeds the simulated ceiling with SIM_TRUTH too.
  CameraNode(lcm::LCM& lcm, const CameraConfig& config, const Clock& clock, SimulatedCeiling& source);

  /// Publishes the newest frame, if there is one. Call it at first, when `descriptor` is readable and when the source
  /// is due.
  void poll();
  [[nodiscard]] int descriptor() const { return source_.descriptor(); }
  /// How long [us] until `poll` is worth calling; nothing = when the descriptor or a message says so.
  [[nodiscard]] std::optional<std::int64_t> time_left() const;
  [[nodiscard]] Health health() const;
  /// What it listens to.
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }

 private:
  void on_odometry(const odometry_t& message);
  void on_truth(const sim_truth_t& message);
  void control_exposure(const Frame& frame);
  void publish(const Frame& frame);
  [[nodiscard]] bool has_lost_lately() const;
  [[nodiscard]] bool fill_jpeg(const GreyView& image, camera_image_t& message);

  lcm::LCM& lcm_;
  CameraConfig config_;
  const Clock& clock_;
  FrameSource& source_;
  SimulatedCeiling* ceiling_ = nullptr;
  ExposureTurns exposure_;
  PictureWatch pictures_;
  StampGuard odometry_stamps_;
  double angular_ = 0.0;  // [rad/s] newest known
  JpegEncoder encoder_;
  int quality_;  // that the last JPEG needed
  Frame frame_;
  camera_image_t message_{};
  std::int64_t lost_frames_ = 0;  // that did not fit into a message
  std::int64_t lost_utime_ = 0;   // [us] stamp of the newest of them
  Subscriber subscriber_;
};

}  // namespace luminav
