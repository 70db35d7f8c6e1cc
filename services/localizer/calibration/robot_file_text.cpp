#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "services/common/configuration/toml_edit.hpp"
#include "services/localizer/calibration/drive_calibration.hpp"

namespace luminav {
namespace {

std::string with_sigma(double value, double sigma) {
  return fmt::format("{:.6f}  # +- {:.6f}, calibrated by driving", value, sigma);
}

std::string error(double sigma) {
  constexpr double kMin = 1e-4;  // an estimate from one drive is never surer than that
  return fmt::format("{:.6f}  # as the calibration left it", std::max(kMin, sigma));
}

}  // namespace

std::string write_into(std::string robot_toml, const DriveCalibration& calibration, const LocalizerConfig& config) {
  const RobotDescription robot = apply(calibration, config.robot, config.building.ceiling_height);
  const CameraMounting& mounting = robot.camera.mounting;
  const double height = config.building.ceiling_height - mounting.z;
  robot_toml = with_keys_set(robot_toml, "camera",
                             {{"z", with_sigma(mounting.z, height * calibration.camera_scale.sigma)},
                              {"roll", with_sigma(mounting.roll, calibration.tilt_y.sigma)},
                              {"pitch", with_sigma(mounting.pitch, calibration.tilt_x.sigma)},
                              {"yaw", with_sigma(mounting.yaw, calibration.yaw.sigma)},
                              {"time_offset", with_sigma(robot.camera.time_offset, calibration.time_offset.sigma)}});
  robot_toml = with_keys_set(robot_toml, "localizer.wheels",
                             {{"scale", with_sigma(calibration.wheel_scale.value, calibration.wheel_scale.sigma)},
                              {"ratio", with_sigma(calibration.wheel_ratio.value, calibration.wheel_ratio.sigma)},
                              {"base", with_sigma(calibration.wheel_base.value, calibration.wheel_base.sigma)}});
  robot_toml = with_keys_set(robot_toml, "localizer.errors",
                             {{"wheel_scale", error(calibration.wheel_scale.sigma)},
                              {"wheel_ratio", error(calibration.wheel_ratio.sigma)},
                              {"wheel_base", error(calibration.wheel_base.sigma)},
                              {"camera_tilt", error(std::max(calibration.tilt_x.sigma, calibration.tilt_y.sigma))},
                              {"camera_yaw", error(calibration.yaw.sigma)},
                              {"camera_scale", error(calibration.camera_scale.sigma)},
                              {"camera_time_offset", error(calibration.time_offset.sigma)}});
  return robot_toml;
}

}  // namespace luminav
