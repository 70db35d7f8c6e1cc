#include "services/detector/detector.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "services/detector/modern_detector.hpp"
#include "services/detector/paper/paper_detector.hpp"
#include "services/detector/sampling/grey_histogram.hpp"

namespace luminav {
namespace {

constexpr int kMinSide = 64;  // [px]
constexpr double kAspectTolerance = 0.01;
constexpr std::size_t kMedianStep = 13;  // every 13th pixel: 23,600 of a webcam's image

void check(bool holds, const std::string& what) {
  if (!holds) {
    throw std::invalid_argument("detector: " + what);
  }
}

CameraIntrinsics scaled(const CameraIntrinsics& lens, int width, int height) {
  CameraIntrinsics result = lens;
  const double sx = static_cast<double>(width) / lens.width;
  const double sy = static_cast<double>(height) / lens.height;
  result.width = width;
  result.height = height;
  result.fx *= sx;
  result.fy *= sy;
  // the corner of the image, half a pixel beyond the centre of the first one, stays where it is
  result.cx = (lens.cx + 0.5) * sx - 0.5;
  result.cy = (lens.cy + 0.5) * sy - 0.5;
  return result;
}

}  // namespace

Detector::Detector(const DetectorParams& params, const CameraDescription& camera, const CeilingCatalogue& catalogue)
    : params_(params), camera_(camera), catalogue_(catalogue) {
  check(catalogue.ceiling_height > camera.mounting.z + 0.2, "the ceiling must be at least 0.2 m above the camera");
  for (const auto* kinds : {&catalogue.fixtures, &catalogue.elements}) {
    for (const CeilingKind& kind : *kinds) {
      check(kind.length >= kind.width && kind.width > 0.01, "a kind's width must be 0.01 m .. its length");
      check(kind.height > camera.mounting.z + 0.2, "a fixture must hang at least 0.2 m above the camera");
    }
  }
  check(params.paper.opening_size >= 1 && params.paper.opening_size <= 31, "opening_size must be 1..31 px");
  check(params.modern.size_tolerance >= 0.0 && params.modern.size_tolerance <= 0.5, "size_tolerance must be 0..0.5");
  check(params.modern.edge_sigma_px > 0.0, "edge_sigma_px must be above 0");
}

Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

bool Detector::accepts(const GreyView& image) const {
  if (image.width < kMinSide || image.height < kMinSide || image.width > 8192 || image.height > 8192 ||
      image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    return false;
  }
  const double sx = static_cast<double>(image.width) / camera_.intrinsics.width;
  const double sy = static_cast<double>(image.height) / camera_.intrinsics.height;
  return std::abs(sx / sy - 1.0) <= kAspectTolerance;
}

void Detector::prepare_for(int width, int height) {
  if (width == width_ && height == height_) {
    return;
  }
  width_ = width;
  height_ = height;
  const CeilingCamera camera(scaled(camera_.intrinsics, width, height), camera_.mounting);
  paper_.reset();
  modern_.reset();
  if (params_.mode == DetectorMode::kPaper) {
    paper_ = std::make_unique<PaperDetector>(params_.paper, camera, catalogue_);
  } else {
    modern_ = std::make_unique<ModernDetector>(params_.modern, camera, catalogue_);
  }
}

const std::vector<Detection>& Detector::detect(const GreyView& image, DetectorTrace* trace) {
  detections_.clear();
  if (!accepts(image)) {
    return detections_;
  }
  prepare_for(image.width, image.height);
  if (paper_) {
    median_grey_ = GreyHistogram(image.pixels, kMedianStep).median();
    paper_->detect(image, median_grey_, detections_, trace);
  } else {
    detections_ = modern_->detect(image, trace);
    median_grey_ = modern_->median_grey();
  }
  return detections_;
}

}  // namespace luminav
