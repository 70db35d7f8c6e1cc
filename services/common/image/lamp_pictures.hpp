#pragma once

#include <cstdint>

namespace luminav {

/// Tells pictures for the lamps, which the camera driver takes in turn with those for the ceiling, by their exposure.
/// What does not burn cannot be seen in them.
class LampPictures {
 public:
  /// Takes up a picture's stamp [us] and exposure [us]; true = far darker than what was taken just before it, for the
  /// lamps. Exposure control changes in smaller steps.
  bool look(std::int64_t utime, double exposure_us) {
    const std::int64_t since = utime - ceiling_utime_;
    if (since >= 0 && since < kMemory && exposure_us < kDarker * ceiling_exposure_us_) {
      return true;
    }
    ceiling_utime_ = utime;
    ceiling_exposure_us_ = exposure_us;
    return false;
  }

 private:
  static constexpr std::int64_t kMemory = 2'000'000;  // [us] a lasting change is one of light
  static constexpr double kDarker = 0.3;

  std::int64_t ceiling_utime_ = 0;
  double ceiling_exposure_us_ = 0.0;
};

}  // namespace luminav
