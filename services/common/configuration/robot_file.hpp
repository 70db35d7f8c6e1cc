#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// The sonar ring: where each disc sits and what one reading means.
struct SonarRing {
  std::vector<Pose2> robot_from_sonar;  // in the order of SONAR; x along the axis
  double minimum_range = 0.10;          // [m] nearer echoes are not measured
  double maximum_range = 5.0;           // [m] reported when nothing echoes
  double half_angle = radians(15.0);    // [rad] of the cone
};

/// What the base can do, and what it is allowed to do.
struct MotionLimits {
  double linear = 0.5;                           // [m/s]
  double angular = radians(60.0);                // [rad/s]
  double linear_acceleration = 0.5;              // [m/s^2]
  double linear_deceleration = 1.0;              // [m/s^2] also used for every stop
  double angular_acceleration = radians(120.0);  // [rad/s^2]
};

/// Camera as it is believed to be: lens, mounting and timing.
struct CameraDescription {
  CameraIntrinsics intrinsics;
  CameraMounting mounting;
  double time_offset = 0.0;       // [s] to add to the image stamp to get the true time
  double row_time = 25e-3 / 480;  // [s] from one row to the next

  bool operator==(const CameraDescription&) const = default;
};

/// What every process may know of the robot; no process has constants of its own about it.
struct RobotDescription {
  std::string name = "p3dx";
  std::string mode = "modern";  // "paper" or "modern": of all nodes that have both and say nothing of their own
  std::vector<Eigen::Vector2d> footprint;  // [m] robot frame, counter-clockwise, convex
  SonarRing sonar;
  MotionLimits limits;
  double wheel_base = 0.33;  // [m] between the drive wheels
  CameraDescription camera;

  /// Radius [m] of the circle round the wheel axis that the footprint sweeps when it turns on the spot.
  [[nodiscard]] double swept_radius() const;
  /// Largest circle [m] round the wheel axis inside the footprint.
  [[nodiscard]] double inscribed_radius() const;
};

/// Reads what is common from the robot's table and marks the nodes' own tables ([p3dx], [detector], ...) as known:
/// each process reads its own with `table("detector")` and rejects what it does not know there.
RobotDescription read_robot(const TomlTable& root);
RobotDescription read_robot(const std::filesystem::path& file);

/// The text of a robot's file with that mode for all nodes, whatever it said before.
std::string with_mode(const std::string& robot_toml, const std::string& mode);

}  // namespace luminav
