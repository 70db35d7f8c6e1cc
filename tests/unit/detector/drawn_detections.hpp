#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "services/detector/detector.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav::test {

/// What the modern detector sees of a drawn ceiling.
inline std::vector<Detection> detect(const DrawnCeiling& ceiling, const CameraDescription& camera = test_camera(),
                                     const CeilingCatalogue& catalogue = test_catalogue()) {
  Detector detector({}, camera, catalogue);
  return detector.detect(draw_ceiling(ceiling, camera, catalogue.ceiling_height).view());
}

inline void expect_at(const Detection& detection, const Pose2& truth, double position, double heading) {
  EXPECT_NEAR(detection.robot_from_fixture.x, truth.x, position);
  EXPECT_NEAR(detection.robot_from_fixture.y, truth.y, position);
  EXPECT_NEAR(wrap_axis(detection.robot_from_fixture.theta - truth.theta), 0.0, heading);
}

}  // namespace luminav::test
