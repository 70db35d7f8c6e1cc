#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "services/common/image/grey_image.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/model/detector_trace.hpp"

namespace luminav {

/// The image in the paper's colours: contours red, rectangles that were tried green, validated fixtures with centre
/// and direction blue; elements grey.
cv::Mat draw_debug_picture(const GreyView& image, const DetectorTrace& trace, const std::vector<Detection>& detections);

}  // namespace luminav
