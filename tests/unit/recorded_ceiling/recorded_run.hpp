#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/detector/model/detector_params.hpp"
#include "services/localizer/localizer_config.hpp"
#include "services/localizer/model/localizer.hpp"

namespace luminav::testing {

/// A robot drives through a hall with fixtures at a regular pitch: pictures that the detector has looked through, and
/// where the recording's author found the robot.
struct RecordedRun {
  struct Frame {
    SightingFrame seen;
    Pose2 world_from_robot;  // reference
  };
  LocalizerConfig config;  // robot, and the hall with its grid of fixtures
  Eigen::Vector2d pitch;   // [m] of the grid
  std::vector<Frame> frames;
};

/// The folder of the recording.
std::filesystem::path recording_folder();

/// Reads it, the camera from one of its robot files. Throws when something is missing.
RecordedRun read_recorded_run(DetectorMode mode = DetectorMode::kModern, const std::string& robot = "fisheye.toml");

/// Offset (x, y, theta) of a pose from the reference, positions modulo the grid [m, rad].
Eigen::Vector3d offset_modulo_grid(const Pose2& pose, const Pose2& reference, const Eigen::Vector2d& pitch);

}  // namespace luminav::testing
