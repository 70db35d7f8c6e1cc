#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/camera_image_t.hpp>
#include <string>
#include <vector>

#include "services/common/image/jpeg_codec.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/detector/detector.hpp"
#include "services/detector/detector_config.hpp"
#include "services/detector/size_watch.hpp"

namespace luminav {

/// CAMERA_IMAGE -> FIXTURE_DETECTIONS, one for each image that can be read, also when nothing was seen in it.
class DetectorNode {
 public:
  DetectorNode(lcm::LCM& lcm, const DetectorConfig& config);

  [[nodiscard]] Health health() const;
  /// What it listens to.
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }

 private:
  void on_camera_image(const camera_image_t& message);
  [[nodiscard]] bool read_image(const camera_image_t& message, GreyView& view);

  lcm::LCM& lcm_;
  Detector detector_;
  JpegDecoder decoder_;
  GreyImage decoded_;
  int calibrated_width_;   // [px]
  int calibrated_height_;  // [px]
  bool refusing_ = false;
  std::string camera_health_;
  SizeWatch sizes_;
  Subscriber subscriber_;
};

}  // namespace luminav
