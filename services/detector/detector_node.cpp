#include "services/detector/detector_node.hpp"

#include <array>
#include <cmath>
#include <luminav/fixture_detections_t.hpp>
#include <utility>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

// in the order of FixtureShape and of DetectionState
constexpr std::array kShapes{fixture_detection_t::SHAPE_RECTANGLE, fixture_detection_t::SHAPE_SQUARE,
                             fixture_detection_t::SHAPE_ROUND};
constexpr std::array kStates{fixture_detection_t::STATE_UNKNOWN, fixture_detection_t::STATE_LIT,
                             fixture_detection_t::STATE_UNLIT, fixture_detection_t::STATE_HALF};

fixture_detection_t encode(const Detection& detection) {
  fixture_detection_t message{};
  message.shape = kShapes[static_cast<std::size_t>(detection.shape)];
  message.state = kStates[static_cast<std::size_t>(detection.state)];
  message.has_theta = detection.has_theta ? 1 : 0;
  message.x = detection.robot_from_fixture.x;
  message.y = detection.robot_from_fixture.y;
  message.theta = detection.robot_from_fixture.theta;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      message.covariance[3 * row + column] = detection.covariance(row, column);
    }
  }
  message.length = detection.length;
  message.width = detection.width;
  message.clipped = detection.clipped ? 1 : 0;
  message.near_end_visible = detection.near_end_visible ? 1 : 0;
  message.far_end_visible = detection.far_end_visible ? 1 : 0;
  message.fit = detection.fit;
  for (std::size_t i = 0; i < 4; ++i) {
    message.corners_px[2 * i] = static_cast<float>(detection.corners_px[i].x());
    message.corners_px[2 * i + 1] = static_cast<float>(detection.corners_px[i].y());
  }
  message.centre_px[0] = static_cast<float>(detection.centre_px.x());
  message.centre_px[1] = static_cast<float>(detection.centre_px.y());
  return message;
}

bool is_finite(const Detection& detection) {
  return all_finite({detection.robot_from_fixture.x, detection.robot_from_fixture.y, detection.robot_from_fixture.theta,
                     detection.fit}) &&
         detection.covariance.allFinite();
}

}  // namespace

DetectorNode::DetectorNode(lcm::LCM& lcm, const DetectorConfig& config)
    : lcm_(lcm),
      detector_(config.params, config.camera, config.catalogue),
      decoder_(config.camera.intrinsics.width, config.camera.intrinsics.height),
      calibrated_width_(config.camera.intrinsics.width),
      calibrated_height_(config.camera.intrinsics.height),
      subscriber_(lcm) {
  subscriber_.on(channels::kCameraImage, &DetectorNode::on_camera_image, this);
}

bool DetectorNode::read_image(const camera_image_t& message, GreyView& view) {
  if (message.format == camera_image_t::FORMAT_JPEG) {
    const bool is_announced = message.width == calibrated_width_ && message.height == calibrated_height_;
    if (is_announced && !decoder_.decode(message.data, decoded_)) {
      subscriber_.drop("CAMERA_IMAGE: a JPEG that is damaged, not whole or of another size than it says");
      return false;
    }
    view = is_announced ? decoded_.view() : GreyView{message.width, message.height, {}};
  } else if (message.format == camera_image_t::FORMAT_MONO8) {
    view = {message.width, message.height, message.data};
  } else {
    subscriber_.drop("CAMERA_IMAGE: unknown format " + std::to_string(message.format));
    return false;
  }
  if (view.width != message.width || view.height != message.height || !detector_.accepts(view)) {
    refusing_ = true;
    subscriber_.drop("CAMERA_IMAGE: " + std::to_string(view.width) + " x " + std::to_string(view.height) + " px (" +
                     std::to_string(view.pixels.size()) + " bytes), the camera is calibrated for " +
                     std::to_string(calibrated_width_) + " x " + std::to_string(calibrated_height_));
    return false;
  }
  refusing_ = false;
  return true;
}

void DetectorNode::on_camera_image(const camera_image_t& message) {
  GreyView view;
  if (!read_image(message, view)) {
    return;
  }
  camera_health_ = message.health;
  fixture_detections_t result{};
  result.utime = message.utime;
  result.sequence = message.sequence;
  result.camera = message.camera;
  result.width = message.width;
  result.height = message.height;
  const std::vector<Detection>& detections = detector_.detect(view);
  sizes_.add(detections);
  for (const Detection& detection : detections) {
    if (is_finite(detection)) {
      result.detections.push_back(encode(detection));
    }
  }
  result.median_grey = detector_.median_grey();
  result.exposure_us = message.exposure_us;
  result.count = static_cast<std::int32_t>(result.detections.size());
  lcm_.publish(channels::kFixtureDetections, &result);
}

Health DetectorNode::health() const {
  Health health;
  health.dropped_inputs = subscriber_.dropped();
  if (refusing_) {
    health.degraded = true;
    health.reason = subscriber_.last_reason();
  } else if (!camera_health_.empty()) {
    health.degraded = true;
    health.reason = "camera: " + camera_health_;
  } else if (std::string complaint = sizes_.complaint(); !complaint.empty()) {
    health.degraded = true;
    health.reason = std::move(complaint);
  }
  return health;
}

}  // namespace luminav
