#include "services/localizer/robot_errors.hpp"

namespace luminav {

RobotErrors read_robot_errors(const TomlTable& table) {
  RobotErrors result;
  const TomlTable wheels = table.table("wheels");
  wheels.read("scale", result.wheels.scale, {-0.2, 0.2});
  wheels.read("ratio", result.wheels.ratio, {-0.2, 0.2});
  wheels.read("base", result.wheels.base, {-0.2, 0.2});
  wheels.reject_unknown();
  const TomlTable errors = table.table("errors");
  errors.read("odometry_position", result.errors.odometry_position, {1e-4, 1.0});
  errors.read("odometry_heading", result.errors.odometry_heading, {1e-5, 1.0});
  errors.read("wheel_scale", result.errors.wheel_scale, {1e-6, 0.2});
  errors.read("wheel_ratio", result.errors.wheel_ratio, {1e-6, 0.2});
  errors.read("wheel_base", result.errors.wheel_base, {1e-6, 0.2});
  errors.read("camera_tilt", result.errors.camera_tilt, {1e-6, 0.2});
  errors.read("camera_yaw", result.errors.camera_yaw, {1e-6, 0.2});
  errors.read("camera_scale", result.errors.camera_scale, {1e-6, 0.2});
  errors.read("camera_time_offset", result.errors.camera_time_offset, {1e-6, 0.5});
  errors.read("lens_residual", result.errors.lens_residual, {0.0, 0.5});
  errors.read("fixture_position", result.errors.fixture_position, {1e-4, 0.5});
  errors.read("fixture_heading", result.errors.fixture_heading, {1e-5, 0.5});
  errors.read("floor_tilt", result.errors.floor_tilt, {0.0, 0.1});
  errors.read("sighting_position", result.errors.sighting_position, {1e-5, 0.5});
  errors.read("sighting_heading", result.errors.sighting_heading, {1e-6, 0.5});
  errors.reject_unknown();
  return result;
}

}  // namespace luminav
