#include "services/detector/sampling/raster.hpp"

#include <opencv2/imgproc.hpp>

namespace luminav {

Raster raster_of(const GreyView& image) {
  return {image.height, image.width, const_cast<std::uint8_t*>(image.pixels.data())};
}

void reduce(const GreyView& image, int factor, Raster& result, int gain) {
  const cv::Size cells(image.width / factor, image.height / factor);
  cv::Mat means = raster_of(image)(cv::Rect({0, 0}, cells * factor));
  if (gain > 1) {
    means.convertTo(means, CV_16U, gain);
  }
  for (; factor > 1; factor /= 2) {  // OpenCV is fast by two only
    cv::Mat squares = means;
    means.release();
    cv::resize(squares, means, squares.size() / 2, 0.0, 0.0, cv::INTER_AREA);
  }
  means.convertTo(result, CV_8U);
}

Raster square_of(int radius) {
  return cv::getStructuringElement(cv::MORPH_RECT, {2 * radius + 1, 2 * radius + 1});
}

}  // namespace luminav
