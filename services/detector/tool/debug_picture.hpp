#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "services/common/image/grey_image.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/model/detector_trace.hpp"

namespace luminav {

/// The image in the paper's colours: contours red, rectangles that were tried green, validated fixtures with centre
/// and direction blue.
cv::Mat draw_debug_picture(const GreyView& image, const DetectorTrace& trace, const std::vector<Detection>& detections);

/// Pictures side by side, each with a caption: what an evaluation shows at one glance.
class ContactSheet {
 public:
  /// A colour picture, drawn with the aspect of the first.
  void add(const cv::Mat& picture, const std::string& caption);
  [[nodiscard]] bool empty() const { return tiles_.empty(); }
  /// All of them; black where a row is not full.
  [[nodiscard]] cv::Mat draw() const;

 private:
  std::vector<cv::Mat> tiles_;
};

}  // namespace luminav
