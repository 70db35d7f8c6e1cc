#pragma once

#include <Eigen/Core>
#include <optional>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/camera_model.hpp"

namespace luminav::score {

/// How the robot moves while a frame is taken, row by row.
struct FrameMotion {
  Pose2 world_from_robot;                              // when the middle row is exposed
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // [m/s] world
  double angular = 0.0;                                // [rad/s]
  double row_time = 0.0;                               // [s] from one row to the next

  /// `row` may lie between two.
  [[nodiscard]] Pose2 world_from_robot_at(double row, int height) const;
};

/// A fixture as one frame shows it.
struct ImagedFixture {
  double share = 0.0;        // 0..1 of its area that is in the image
  bool is_whole = false;     // all of its outline is in the image
  Pose2 robot_from_fixture;  // true, at the instant when the row that shows its centre was exposed
  Pose2 as_imaged;           // of the rigid shape that fits what the image shows of its outline best: a rolling shutter
                             // shears the picture, and an image alone does not tell
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();  // of as_imaged
};

/// What a camera sees of a fixture, each point at its own row's instant; nothing when no part of it is in the image.
std::optional<ImagedFixture> image_of(const Fixture& fixture, const FrameMotion& motion, const CeilingCamera& camera);

}  // namespace luminav::score
