#include "services/detector/tool/debug_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <span>

#include "services/detector/sampling/raster.hpp"

namespace luminav {
namespace {

constexpr int kColumns = 3;   // of a contact sheet
constexpr int kWidth = 320;   // [px] of each picture in it
constexpr int kCaption = 16;  // [px] below each
constexpr int kGap = 4;       // [px] between them
const cv::Scalar kRed(0, 0, 255);
const cv::Scalar kGreen(0, 200, 0);
const cv::Scalar kBlue(255, 80, 0);

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
  cv::Mat picture;
  cv::cvtColor(raster_of(image), picture, cv::COLOR_GRAY2BGR);
  for (const auto& contour : trace.contours) {
    draw_outline(picture, contour, kRed, 1);
  }
  for (const auto& rectangle : trace.rectangles) {
    draw_outline(picture, rectangle, kGreen, 1);
  }
  for (const Detection& detection : detections) {
    draw_outline(picture, detection.corners_px, kBlue, 2);
    cv::circle(picture, to_point(detection.centre_px), 4, kBlue, cv::FILLED, cv::LINE_AA);
    if (detection.has_theta) {
      const Eigen::Vector2d far_end = 0.5 * (detection.corners_px[0] + detection.corners_px[3]);
      cv::line(picture, to_point(detection.centre_px), to_point(far_end), kBlue, 2, cv::LINE_AA);
    }
  }
  return picture;
}

void ContactSheet::add(const cv::Mat& picture, const std::string& caption) {
  const int height = tiles_.empty() ? std::max(1, picture.rows * kWidth / std::max(1, picture.cols))
                                    : tiles_.front().rows - kCaption - kGap;
  cv::Mat tile(height + kCaption + kGap, kWidth + kGap, CV_8UC3, cv::Scalar(0, 0, 0));
  tile(cv::Rect(0, height, kWidth, kCaption)) = cv::Scalar(255, 255, 255);
  cv::resize(picture, tile(cv::Rect(0, 0, kWidth, height)), {kWidth, height}, 0.0, 0.0, cv::INTER_AREA);
  cv::putText(tile, caption, {4, height + kCaption - 4}, cv::FONT_HERSHEY_SIMPLEX, 0.38, cv::Scalar(0, 0, 0), 1,
              cv::LINE_AA);
  tiles_.push_back(tile);
}

cv::Mat ContactSheet::draw() const {
  const int count = static_cast<int>(tiles_.size());
  const cv::Size tile = tiles_.empty() ? cv::Size(1, 1) : tiles_.front().size();
  const int columns = std::clamp(count, 1, kColumns);
  cv::Mat sheet = cv::Mat::zeros((count + columns - 1) / columns * tile.height, columns * tile.width, CV_8UC3);
  for (int i = 0; i < count; ++i) {
    const cv::Point corner(i % columns * tile.width, i / columns * tile.height);
    tiles_[static_cast<std::size_t>(i)].copyTo(sheet(cv::Rect(corner, tile)));
  }
  return sheet;
}

}  // namespace luminav
