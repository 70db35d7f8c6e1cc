#pragma once

#include <cstdint>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/model/detection.hpp"
#include "services/detector/outline/ceiling_catalogue.hpp"

namespace luminav::test {

/// A fixture or a dark patch in the picture, robot frame.
struct DrawnShape {
  Pose2 pose;
  FixtureShape shape = FixtureShape::kRectangle;
  double length = 1.2;
  double width = 0.3;
  DetectionState state = DetectionState::kLit;
  double darker = 25.0;     // [grey] that an unlit one, or its dark half, lies below the ceiling
  double half_bloom = 0.0;  // [grey] at the edge of the burning half of one that burns by half
  double slats = 0.0;       // [grey] by which stripes 50 mm apart differ from that, but for a frame of 30 mm
};

/// Everything that makes a picture of a ceiling hard, in grey levels.
struct DrawnCeiling {
  std::vector<DrawnShape> shapes = {};
  double grey = 110.0;
  double slope_x = 0.0;  // [grey/m] of daylight, robot frame
  double slope_y = 0.0;
  double joint_depth = 0.0;   // [grey] of the dark lines between tiles of 0.6 m
  double lamp = 600.0;        // [grey] of a lit fixture, clipped at 255
  double bloom = 80.0;        // [grey] at the edge of a lit one
  double bloom_reach = 0.03;  // [m] to 1/e
  double blur = 0.004;        // [m] over which edges fade, 1 sigma
  double noise = 4.0;         // [grey]
  std::uint32_t seed = 1;
};

GreyImage draw_ceiling(const DrawnCeiling& ceiling, const CameraDescription& camera, double height);

/// The webcam that the tests look through: 60 degrees, some distortion, 0.3 m above the floor.
CameraDescription test_camera();
/// Fixtures of one and of two lamps, vents, a smoke detector, under a ceiling at 2.8 m.
CeilingCatalogue test_catalogue();

}  // namespace luminav::test
