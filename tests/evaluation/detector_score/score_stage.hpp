#pragma once

#include <string>
#include <vector>

#include "drivers/camera/simulated/renderer.hpp"
#include "services/common/image/jpeg_codec.hpp"
#include "services/detector/detector.hpp"
#include "tests/evaluation/detector_score/condition_frames.hpp"
#include "tests/evaluation/detector_score/detector_score.hpp"

namespace luminav::score {

/// A true ceiling, the camera below it and the detector that is told some of it.
class ScoreStage {
 public:
  /// `told` is what the detector knows: the camera and the building's kinds. `lamps` are the states of the model's
  /// fixtures.
  ScoreStage(const simulated::CeilingModel& model, const DetectorParams& params, const CameraDescription& told_camera,
             const Building& told, std::vector<simulated::LampState> lamps);

  /// Renders a frame, detects, compares with the truth and adds to the score; the listener may be empty. `factor` is
  /// the condition's error of the exposure.
  void score_frame(const std::string& name, const Place& place, double factor, simulated::Exposure exposure, bool jpeg,
                   const FrameListener& listener, DetectorScore& score);

 private:
  Building truth_;
  simulated::CeilingRenderer renderer_;
  CeilingCamera camera_;
  Detector detector_;
  std::vector<simulated::LampState> lamps_;
  JpegEncoder encoder_;
  JpegDecoder decoder_;
};

}  // namespace luminav::score
