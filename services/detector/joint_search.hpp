#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/side_profile.hpp"

namespace luminav {

struct JointSearch {
  double nearest = -0.010;     // [m] of the joint's middle from the side, outwards
  double farthest = 0.018;     // [m]
  double from_corner = 0.025;  // [m] beyond a corner where to begin to look
  double apart = 0.012;        // [m] between the lines looked at, along the side
  int lines = 16;              // beyond each corner
  double noise = 4.0;          // [grey] of a pixel
};

struct JointBeside {
  bool is_in_view = false;  // whether it was possible to look
  bool found = false;
  double middle = 0.0;  // [m] of the joint, outwards of the side
  double end = 0.0;     // [m] of its outer edge
  double depth = 0.0;   // [grey] below the ceiling on both sides of it
};

/// Looks for a joint of the ceiling that runs along a side of a fixture. Beside the fixture it may hide in the edge or
/// in bloom, but it goes on beyond the fixture's corners: there the mean profile across the side's line shows it.
JointBeside find_joint_beside(const GreyView& image, const CeilingCamera& camera, const SideLine& side,
                              const JointSearch& search);

}  // namespace luminav
