#include "services/detector/coarse_glance.hpp"

#include <gtest/gtest.h>

#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

constexpr double kHeight = 2.8;
constexpr Outline kOutline{.length = 1.2, .width = 0.3, .height = kHeight};
constexpr double kLeastStep = -3.5;  // [grey]

/// Looks at a picture with a faint unlit fixture at {0.2, -0.1, 0.4} in noise.
bool may_be_at(const Pose2& place) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {0.2, -0.1, 0.4}, .state = DetectionState::kUnlit, .darker = 8.0}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  Raster reduced;
  reduce(image.view(), 4, reduced);
  const CeilingFrame frame{image.view(), reduced, reduced};
  return may_have_long_sides(frame, model, kOutline, place, kLeastStep);
}

TEST(CoarseGlance, SeesAFaintFixtureInNoiseFromANearbyStart) {
  EXPECT_TRUE(may_be_at({0.2, -0.1, 0.4}));
  EXPECT_TRUE(may_be_at({0.22, -0.12, 0.42}));
}

TEST(CoarseGlance, RefutesAPlaceOfWhichOneSideLiesOnBareCeiling) {
  EXPECT_FALSE(may_be_at({0.1, 0.15, 0.4}));
}

TEST(CoarseGlance, SaysNothingAgainstWhatIsOutOfView) {
  EXPECT_TRUE(may_be_at({40.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace luminav
