#include "services/localizer/robot_errors.hpp"

namespace luminav {
namespace {

void read_wheels(const TomlTable& table, WheelCorrection& wheels) {
  table.read("scale", wheels.scale, {-0.2, 0.2});
  table.read("ratio", wheels.ratio, {-0.2, 0.2});
  table.read("base", wheels.base, {-0.2, 0.2});
  table.reject_unknown();
}

void read_errors(const TomlTable& table, ErrorParams& errors) {
  table.read("odometry_position", errors.odometry_position, {1e-4, 1.0});
  table.read("odometry_heading", errors.odometry_heading, {1e-5, 1.0});
  table.read("wheel_scale", errors.wheel_scale, {1e-6, 0.2});
  table.read("wheel_ratio", errors.wheel_ratio, {1e-6, 0.2});
  table.read("wheel_base", errors.wheel_base, {1e-6, 0.2});
  table.read("camera_tilt", errors.camera_tilt, {1e-6, 0.2});
  table.read("camera_yaw", errors.camera_yaw, {1e-6, 0.2});
  table.read("camera_scale", errors.camera_scale, {1e-6, 0.2});
  table.read("camera_time_offset", errors.camera_time_offset, {1e-6, 0.5});
  table.read("lens_residual", errors.lens_residual, {0.0, 0.5});
  table.read("fixture_position", errors.fixture_position, {1e-4, 0.5});
  table.read("fixture_heading", errors.fixture_heading, {1e-5, 0.5});
  table.read("floor_tilt", errors.floor_tilt, {0.0, 0.1});
  table.read("sighting_position", errors.sighting_position, {1e-5, 0.5});
  table.read("sighting_heading", errors.sighting_heading, {1e-6, 0.5});
  table.reject_unknown();
}

}  // namespace

RobotErrors read_robot_errors(const TomlTable& table) {
  RobotErrors result;
  read_wheels(table.table("wheels"), result.wheels);
  read_errors(table.table("errors"), result.errors);
  return result;
}

}  // namespace luminav
