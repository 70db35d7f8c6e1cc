#pragma once

#include <string>
#include <vector>

#include "services/localizer/calibration/drive_log.hpp"
#include "services/localizer/model/wheel_correction.hpp"

namespace luminav {

/// A number and how well it is known.
struct CalibratedValue {
  double value = 0.0;
  double sigma = 0.0;  // 1-sigma
};

/// What one drive tells of the robot: the wheels' whole correction, and what has to be added to what the robot's file
/// believes of the camera.
struct DriveCalibration {
  CalibratedValue wheel_scale;   // fraction, as in WheelCorrection
  CalibratedValue wheel_ratio;   // likewise
  CalibratedValue wheel_base;    // likewise
  CalibratedValue tilt_x;        // [rad] shift of the ceiling's picture along x per metre of height
  CalibratedValue tilt_y;        // [rad] likewise along y
  CalibratedValue yaw;           // [rad]
  CalibratedValue camera_scale;  // fraction: of the height between camera and ceiling
  CalibratedValue time_offset;   // [s]
  std::size_t frames = 0;
  std::size_t sightings = 0;
  double distance = 0.0;  // [m]
  double residual = 0.0;  // root mean square of the sightings' residuals in deviations
  bool has_converged = false;

  /// False where no robot explains what was seen: of a drive through a wrong pose nothing may be used.
  [[nodiscard]] bool fits() const { return has_converged && residual < 3.0; }
};

/// Batch estimate over a whole drive: all poses, the fixtures' own errors and the robot's, with the priors of `errors`.
/// Cost: seconds for a drive of minutes.
DriveCalibration calibrate_drive(const std::vector<KnownFrame>& frames, const LocalizerConfig& config);

/// The robot's description with the calibration taken in; the wheels' part goes into `wheels`.
RobotDescription apply(const DriveCalibration& calibration, const RobotDescription& robot, double ceiling_height);

/// The text of a robot's file with the calibration written into [camera], [localizer.wheels] and [localizer.errors],
/// everything else left as it is.
std::string write_into(std::string robot_toml, const DriveCalibration& calibration, const LocalizerConfig& config);

}  // namespace luminav
