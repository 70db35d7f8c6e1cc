#include "services/detector/tool/contact_sheet.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace luminav {
namespace {

constexpr int kGap = 4;       // [px] between pictures
constexpr int kCaption = 16;  // [px] below each

}  // namespace

void ContactSheet::add(const cv::Mat& picture, const std::string& caption) {
  const int height = std::max(1, picture.rows * width_ / std::max(1, picture.cols));
  cv::Mat tile(height + kCaption, width_, CV_8UC3, cv::Scalar(255, 255, 255));
  cv::resize(picture, tile(cv::Rect(0, 0, width_, height)), {width_, height}, 0.0, 0.0, cv::INTER_AREA);
  cv::putText(tile, caption, {4, height + kCaption - 4}, cv::FONT_HERSHEY_SIMPLEX, 0.38, cv::Scalar(0, 0, 0), 1,
              cv::LINE_AA);
  tiles_.push_back(tile);
}

cv::Mat ContactSheet::draw() const {
  int height = 1;
  for (const cv::Mat& tile : tiles_) {
    height = std::max(height, tile.rows);
  }
  const int count = static_cast<int>(tiles_.size());
  const int columns = std::clamp(count, 1, columns_);
  const int rows = std::max(1, (count + columns - 1) / columns);
  cv::Mat sheet(rows * (height + kGap), columns * (width_ + kGap), CV_8UC3, cv::Scalar(0, 0, 0));
  for (int i = 0; i < count; ++i) {
    const cv::Mat& tile = tiles_[static_cast<std::size_t>(i)];
    const cv::Rect place((i % columns) * (width_ + kGap), (i / columns) * (height + kGap), width_, tile.rows);
    tile.copyTo(sheet(place));
  }
  return sheet;
}

}  // namespace luminav
