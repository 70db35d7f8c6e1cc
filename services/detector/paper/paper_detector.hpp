#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/detector/model/detector_trace.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"

namespace luminav {

/// The chain of "Localization and Navigation of a Mobile Robot in an Office-like Environment", step by step: two
/// thresholds, combined and each for itself; opening; contours; validation by area, length and width; moments and the
/// minimum-area rectangle; pose through the calibrated camera. Whole rectangles only, as there.
class PaperDetector {
 public:
  PaperDetector(const PaperParams& params, const CeilingCamera& camera, const CeilingCatalogue& catalogue);

  /// `median`: of the image [grey]. `trace` may be null.
  void detect(const GreyView& image, double median, std::vector<Detection>& detections, DetectorTrace* trace);

 private:
  void segment(const cv::Mat& image, double median);
  void find_contours(const cv::Mat& mask);
  /// Adds what fits a fixture and was not found in a mask before.
  void add_fixtures(std::vector<Detection>& detections, DetectorTrace* trace) const;
  struct Range {
    double low = 1e9;
    double high = 0.0;
    void add(double value) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  };
  [[nodiscard]] std::optional<Detection> fixture_of(const std::vector<cv::Point>& contour) const;
  [[nodiscard]] bool is_cut(const std::vector<cv::Point>& contour) const;
  [[nodiscard]] bool fits(const Detection& detection) const;
  [[nodiscard]] DetectionState state_of(const std::vector<cv::Point>& contour) const;
  [[nodiscard]] std::optional<Detection> pose_of(const cv::Point2d& centre, const cv::RotatedRect& rectangle) const;

  PaperParams params_;
  CeilingCamera camera_;
  double height_;  // [m] of the ceiling
  Range lengths_;  // [m] of the building's rectangular fixtures
  Range widths_;   // [m] from one lamp to two
  cv::Mat lit_;
  cv::Mat unlit_;
  cv::Mat combined_;
  cv::Mat opened_;
  cv::Mat edges_;
  std::vector<std::vector<cv::Point>> contours_;
};

}  // namespace luminav
