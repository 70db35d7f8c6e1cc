#include "services/detector/tool/debug_picture.hpp"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <span>

namespace luminav {
namespace {

const cv::Scalar kRed(0, 0, 255);
const cv::Scalar kGreen(0, 200, 0);
const cv::Scalar kBlue(255, 80, 0);
const cv::Scalar kGrey(160, 160, 160);

// Far outside of the picture nothing is worth drawing, and the drawing functions count in 16 bits.
cv::Point to_point(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(std::lround(std::clamp(pixel.x(), -8000.0, 8000.0))),
          static_cast<int>(std::lround(std::clamp(pixel.y(), -8000.0, 8000.0)))};
}

void draw_outline(cv::Mat& picture, std::span<const Eigen::Vector2d> corners, const cv::Scalar& colour, int width) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    cv::line(picture, to_point(corners[i]), to_point(corners[(i + 1) % corners.size()]), colour, width, cv::LINE_AA);
  }
}

}  // namespace

cv::Mat draw_debug_picture(const GreyView& image, const DetectorTrace& trace,
                           const std::vector<Detection>& detections) {
  const cv::Mat grey(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat picture;
  cv::cvtColor(grey, picture, cv::COLOR_GRAY2BGR);
  for (const auto& contour : trace.contours) {
    draw_outline(picture, contour, kRed, 1);
  }
  for (const auto& rectangle : trace.rectangles) {
    draw_outline(picture, rectangle, kGreen, 1);
  }
  for (const Detection& detection : detections) {
    const cv::Scalar& colour = detection.shape == DetectionShape::kElement ? kGrey : kBlue;
    draw_outline(picture, detection.corners_px, colour, 2);
    cv::circle(picture, to_point(detection.centre_px), 4, colour, cv::FILLED, cv::LINE_AA);
    if (detection.has_theta) {
      const Eigen::Vector2d far_end = 0.5 * (detection.corners_px[0] + detection.corners_px[3]);
      cv::line(picture, to_point(detection.centre_px), to_point(far_end), colour, 2, cv::LINE_AA);
    }
  }
  return picture;
}

}  // namespace luminav
