#pragma once

#include <string>

#include "drivers/camera/exposure_control.hpp"

namespace luminav {

/// Exposes frames for the ceiling, as `ExposureControl` has it, and, with `two_exposures` and while lamps burn, some
/// for the lamps in turn. Lamps and an unlit ceiling do not fit into eight bits at once: what shows the ceiling well
/// drowns lamps and what they light in one white region. Devices show a new exposure some frames late, and some report
/// it at once: the pictures themselves tell what they were taken for.
class ExposureTurns {
 public:
  /// Throws std::invalid_argument for parameters that contradict each other.
  explicit ExposureTurns(const ExposureParams& params);

  /// Setting for the frames to come, given one frame, the exposure and gain it is said to be taken with, and how fast
  /// the robot turns [rad/s].
  ExposureSetting update(const GreyView& image, double exposure_us, double gain, double angular);

  [[nodiscard]] ExposureSetting setting() const;
  /// [us] that the frame given last was taken with, if the device says `reported`.
  [[nodiscard]] double exposure_of_last(double reported) const;
  /// "" or why brightness is not as wanted, in one plain sentence.
  [[nodiscard]] const std::string& complaint() const;

 private:
  enum class Turn { kCeiling, kLamps, kBackToCeiling };

  [[nodiscard]] double lamp_exposure_us() const;
  void begin(Turn turn);
  void expose_ceiling(const CeilingBrightness& brightness, double exposure_us, double gain, double angular);
  void end_lamps();

  ExposureParams params_;
  ExposureControl ceiling_;
  Turn turn_ = Turn::kCeiling;
  int waited_ = 0;             // [frames] of this turn
  int taken_ = 0;              // [frames] of this turn that were taken for it
  int ignored_ = 0;            // turns for lamps in a row that the device did not follow
  int since_lamp_;             // [frames] since one for the ceiling showed a burning lamp
  double ceiling_mean_ = 0.0;  // [grey levels] of the newest frame for the ceiling
  bool is_for_lamps_ = false;  // the frame given last
  std::string complaint_;
};

}  // namespace luminav
