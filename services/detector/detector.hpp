#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/detector/model/detector_trace.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"

namespace luminav {

class PaperDetector;
class ModernDetector;

/// Finds the ceiling's light fixtures in grey images. Images of another size than the calibration's are taken when the
/// aspect is the same: the camera model is scaled.
class Detector {
 public:
  /// Throws std::invalid_argument for parameters that make no sense and for a ceiling below the camera.
  Detector(const DetectorParams& params, const CameraDescription& camera, const CeilingCatalogue& catalogue);
  ~Detector();
  Detector(Detector&&) noexcept;
  Detector& operator=(Detector&&) noexcept;

  /// Everything seen in an image; empty also for an image that `accepts` refuses. Valid until the next call. The modern
  /// mode allocates nothing once it is warm.
  /// `trace`, when given, collects what was looked at on the way.
  [[nodiscard]] const std::vector<Detection>& detect(const GreyView& image, DetectorTrace* trace = nullptr);
  /// True when the image is whole and its aspect fits the calibration within 1 %.
  [[nodiscard]] bool accepts(const GreyView& image) const;
  /// Median grey level of the last image.
  [[nodiscard]] double median_grey() const { return median_grey_; }
  [[nodiscard]] const DetectorParams& params() const { return params_; }

 private:
  void prepare_for(int width, int height);

  DetectorParams params_;
  CameraDescription camera_;
  CeilingCatalogue catalogue_;
  int width_ = 0;   // [px] of the images that the detectors below are prepared for
  int height_ = 0;  // [px]
  std::unique_ptr<PaperDetector> paper_;
  std::unique_ptr<ModernDetector> modern_;
  std::vector<Detection> detections_;  // of the last image
  double median_grey_ = 0.0;
};

}  // namespace luminav
