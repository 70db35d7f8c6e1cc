#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/detection.hpp"
#include "services/detector/detector_params.hpp"
#include "services/detector/detector_trace.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"

namespace luminav {

/// The chain of "Localization and Navigation of a Mobile Robot in an Office-like Environment", step by step: two
/// thresholds, combined; opening; contours; validation by area, length and width; moments and the minimum-area
/// rectangle; pose through the calibrated camera. Whole rectangles only, as there.
class PaperDetector {
 public:
  PaperDetector(const PaperParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue);

  /// `median`: of the image [grey]. `trace` may be null.
  void detect(const GreyView& image, double median, std::vector<Detection>& detections, DetectorTrace* trace);

 private:
  void segment(const cv::Mat& image, double median);
  [[nodiscard]] bool is_fixture(const std::vector<cv::Point>& contour, const cv::RotatedRect& rectangle) const;
  [[nodiscard]] DetectionState state_of(const std::vector<cv::Point>& contour) const;
  [[nodiscard]] bool pose_of(const cv::Point2d& centre, const cv::RotatedRect& rectangle, Detection& detection) const;

  PaperParams params_;
  CeilingCamera camera_;
  double height_;     // [m] of the ceiling
  double shortest_;   // [m] long side
  double longest_;    // [m]
  double narrowest_;  // [m] width of one lamp
  double widest_;     // [m] width of two lamps
  double pixels_per_metre_;
  cv::Mat lit_;
  cv::Mat unlit_;
  cv::Mat mask_;
  cv::Mat edges_;
  std::vector<std::vector<cv::Point>> contours_;
};

}  // namespace luminav
