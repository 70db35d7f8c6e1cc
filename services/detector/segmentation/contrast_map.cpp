#include "services/detector/segmentation/contrast_map.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "services/detector/sampling/grey_histogram.hpp"

namespace luminav {
namespace {

constexpr double kCap = 6.0;          // [grey] by which the ceiling may rise above its own opening (tiles, their grid)
constexpr double kFlatLevel = 128.0;  // [grey] of a flattened image
const cv::Point kMiddle(-1, -1);

/// Continues the image beyond its borders point-symmetrically, so that a slope stays a slope there. Without it the
/// surroundings of a border cell would all lie on one side, and shading alone would give it contrast.
Raster continued(const Raster& image, int margin) {
  Raster edge;
  Raster mirrored;
  Raster result;
  cv::copyMakeBorder(image, edge, margin, margin, margin, margin, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(image, mirrored, margin, margin, margin, margin, cv::BORDER_REFLECT_101);
  cv::addWeighted(edge, 2.0, mirrored, -1.0, 0.0, result);
  return result;
}

/// What everything becomes that is narrower than a window and darker than what lies around it. A closing fills a hollow
/// only up to its lowest rim: without the light's slope, the rim is the same all round. The slope is taken from the
/// opening, or a lamp would make a hollow of its own beside it.
Raster surroundings_of(const Raster& image, int radius) {
  const Raster window = square_of(radius);
  const int margin = 2 * radius;
  const cv::Rect inner(margin, margin, image.cols, image.rows);
  const cv::Mat wide = continued(image, margin);
  cv::Mat opened;  // without lamps
  cv::Mat mean;
  cv::Mat flat;
  Raster result;
  cv::morphologyEx(wide, opened, cv::MORPH_OPEN, window);
  cv::blur(opened, mean, window.size(), kMiddle, cv::BORDER_REPLICATE);
  cv::add(opened, kCap, flat);
  cv::min(wide, flat, flat);
  cv::addWeighted(flat, 1.0, mean, -1.0, kFlatLevel, flat);
  cv::morphologyEx(flat, flat, cv::MORPH_CLOSE, window);
  cv::addWeighted(flat(inner), 1.0, mean(inner), 1.0, -kFlatLevel, result);
  return result;
}

}  // namespace

double ContrastMap::noise_of(const Raster& image) {
  constexpr double kMinNoise = 0.3;
  constexpr std::size_t kSamples = 4096;
  Raster steps;
  cv::absdiff(image.colRange(1, image.cols), image.colRange(0, image.cols - 1), steps);
  // median of |a - b| = 0.954 sigma of one
  return std::max(kMinNoise,
                  GreyHistogram(cells_of(steps), 1 + steps.total() / kSamples).interpolated_median() / 0.954);
}

void ContrastMap::compute(const Raster& image, int radius, bool ignore_lines) {
  Raster clean = image;
  if (ignore_lines) {
    clean.release();
    cv::morphologyEx(image, clean, cv::MORPH_CLOSE, square_of(1));
  }
  Raster half;  // surroundings are smooth, so they may be computed coarsely
  reduce(view_of(clean), 2, half);
  Raster level;
  cv::resize(surroundings_of(half, std::max(1, (radius + 1) / 2)), level, clean.size(), 0.0, 0.0, cv::INTER_NEAREST);
  cv::blur(clean, dark_, {3, 3}, kMiddle, cv::BORDER_REPLICATE);
  cv::subtract(level, dark_, dark_);
}

void ContrastMap::compute_narrow(const Raster& image, int radius, bool is_noisy) {
  Raster smooth = image;
  if (is_noisy) {
    smooth.release();
    cv::blur(image, smooth, {3, 3}, kMiddle, cv::BORDER_REPLICATE);
  }
  cv::morphologyEx(smooth, dark_, cv::MORPH_CLOSE, square_of(radius));
  cv::subtract(dark_, smooth, dark_);
}

const Raster& ContrastMap::eroded() {
  cv::erode(dark_, eroded_, square_of(1));
  return eroded_;
}

}  // namespace luminav
