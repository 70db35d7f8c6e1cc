#include <gtest/gtest.h>

#include <cmath>

#include "services/detector/outline_fit.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

constexpr double kHeight = 2.8;

TEST(OutlineFitter, FindsTheOutlineFromANearbyStartToATenthOfAPixel) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const Pose2 truth{0.2, -0.1, 0.4};
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = truth}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  OutlineFitter fitter(model);
  const auto fit = fitter.fit(image.view(), {.length = 1.2, .width = 0.3, .height = kHeight}, {},
                              {truth.x + 0.02, truth.y - 0.015, truth.theta + 0.02});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->robot_from_outline.x, truth.x, 0.45e-3);  // 4.5 mm per pixel
  EXPECT_NEAR(fit->robot_from_outline.y, truth.y, 0.45e-3);
  EXPECT_NEAR(fit->robot_from_outline.theta, truth.theta, radians(0.05));
  EXPECT_GT(fit->quality(), 0.95);
  EXPECT_TRUE(fit->end_visible(kFarEnd));
  EXPECT_TRUE(fit->end_visible(kNearEnd));
}

TEST(OutlineFitter, LeavesThePlaceAlongAnEndlessStripUncertain) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = {0.0, 0.0, 0.0}, .length = 6.0}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  OutlineFitter fitter(model);
  const auto fit = fitter.fit(image.view(), {.length = 6.0, .width = 0.3, .height = kHeight}, {}, {0.0, 0.01, 0.01});
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->end_visible(kFarEnd));
  EXPECT_FALSE(fit->end_visible(kNearEnd));
  EXPECT_GT(fit->covariance(0, 0), 0.1);
  EXPECT_LT(fit->covariance(1, 1), 1e-6);
}

TEST(OutlineFitter, RefusesAPlaceWithoutEdges) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const GreyImage image = test::draw_ceiling({}, camera, kHeight);
  OutlineFitter fitter(model);
  EXPECT_FALSE(fitter.fit(image.view(), {.length = 1.2, .width = 0.3, .height = kHeight}, {}, {0.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace luminav
