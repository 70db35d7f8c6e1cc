#include "tests/figures/detection_picture.hpp"

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "services/detector/detector_config.hpp"
#include "services/detector/tool/debug_picture.hpp"

namespace luminav {
namespace {

Detector paper_detector(const std::filesystem::path& robot_file, const std::filesystem::path& building_file) {
  DetectorConfig config = read_detector_config(robot_file, building_file);
  config.params.mode = DetectorMode::kPaper;
  return {config.params, config.camera, config.catalogue};
}

}  // namespace

DetectionPicture::DetectionPicture(const std::filesystem::path& robot_file, const std::filesystem::path& building_file)
    : detector_(paper_detector(robot_file, building_file)) {}

void DetectionPicture::look_at(const camera_image_t& image) {
  if (image.format != camera_image_t::FORMAT_MONO8) {
    return;
  }
  const GreyView view{image.width, image.height, image.data};
  DetectorTrace trace;
  const std::vector<Detection>& detections = detector_.detect(view, &trace);
  if (detections.size() > max_) {
    max_ = detections.size();
    picture_ = draw_debug_picture(view, trace, detections);
  }
}

void DetectionPicture::write(const std::filesystem::path& png_file) const {
  if (picture_.empty()) {
    throw std::runtime_error("no fixture was seen on the whole drive");
  }
  if (!cv::imwrite(png_file.string(), picture_)) {
    throw std::runtime_error(png_file.string() + ": cannot be written");
  }
}

}  // namespace luminav
