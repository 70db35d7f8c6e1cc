#pragma once

#include <cstdint>
#include <vector>

namespace luminav::simulated {

/// From brightness to grey: vignetting, exposure, noise and saturation.
class SensorResponse {
 public:
  static constexpr double kNominalExposureUs = 8000.0;  // [us] at gain 1: brightness 1 gives
  static constexpr double kNominalGrey = 100.0;         // this grey level

  /// `grey_noise` is the 1-sigma [grey levels] at gain 1.
  SensorResponse(int width, int height, double grey_noise, std::uint64_t seed);

  /// What holds for all rows of a frame.
  void begin_frame(std::uint64_t frame, double exposure_us, double gain);
  /// Grey levels of one row.
  void develop(int row, const float* brightness, std::uint8_t* grey) const;

 private:
  int width_;
  int height_;
  double grey_noise_;
  std::uint64_t seed_;
  std::vector<float> noise_;     // 1-sigma 1; a row starts anywhere in it
  std::vector<float> vignette_;  // loss by the column's distance to the middle
  std::uint64_t frame_ = 0;
  float scale_ = 0.0F;  // grey levels per brightness
  float sigma_ = 0.0F;  // [grey levels]
};

}  // namespace luminav::simulated
