#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drivers/camera/simulated/catalogue/clutter.hpp"
#include "drivers/camera/simulated/truth.hpp"
#include "drivers/simulator/world/luminaire_kind.hpp"
#include "services/common/building/building.hpp"
#include "services/common/geometry/camera_model.hpp"

namespace luminav::simulated {

/// The ceiling and the camera as they truly are.
struct CeilingModel {
  Building building;
  CameraIntrinsics intrinsics;
  CameraMounting mounting;
  double grey_noise = 4.0;                // [grey levels] 1-sigma at gain 1
  std::vector<double> unlit_darker;       // [grey levels] per fixture, against a tile at level 100
  std::vector<LuminaireKind> luminaires;  // per fixture; where none is given, a panel
  std::vector<ClutterItem> clutter;       // besides the building's elements
  std::uint64_t seed = 1;
};

/// How one frame is taken.
struct Exposure {
  std::uint64_t number = 0;                            // of the frame: other noise for each
  double utime = 0.0;                                  // [us] true mid-exposure of the middle row
  double exposure_us = 8000.0;                         // [us]
  double gain = 1.0;                                   // 1 = none
  double row_time_us = 0.0;                            // [us] from one row to the next
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // [m/s] of the robot, world, for motion blur
  double angular = 0.0;                                // [rad/s]
};

/// The camera in space at one instant.
struct View {
  Eigen::Vector3d lens;              // [m] world
  Eigen::Matrix3d world_from_robot;  // rotation, the floor's tilt included
};
View view_from(const CameraMounting& mounting, const TruePose& pose);

/// What holds for a whole frame, at its middle row.
struct FrameGeometry {
  View view;
  Eigen::Vector2d origin;  // [m] world, below the lens; points of the picture count from it, which keeps floats exact
  Eigen::Vector2d motion;  // [m] by which the picture of the point above the origin moves during the exposure
  double turn;             // [rad] during the exposure
  double rise;             // [m] from the lens to the ceiling
  double reach;            // [per m of rise] largest distance from the point above the lens that a pixel sees
  double slack;            // [m] by which the rows' views of the ceiling differ from the middle one's
};
/// `reach` as in the result.
FrameGeometry geometry_of(const CeilingModel& model, const Exposure& exposure, const TruePose& middle, double reach);

/// Side [m] of the part of a plane `height` [m] above the floor that a pixel sees at a point of the world, or at the
/// nearest that any pixel sees.
double metres_per_pixel(const CeilingModel& model, const FrameGeometry& frame, const Eigen::Vector2d& point,
                        double height);

}  // namespace luminav::simulated
