#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/detector/outline/edge_search.hpp"
#include "services/detector/outline/outline_fit.hpp"
#include "tests/unit/detector/ceiling_picture.hpp"

namespace luminav {
namespace {

constexpr double kHeight = 2.8;

TEST(OutlineFitter, FindsTheOutlineFromANearbyStartToAThirdOfAPixel) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const Pose2 truth{0.2, -0.1, 0.4};
  test::DrawnCeiling ceiling;
  ceiling.shapes = {{.pose = truth}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  OutlineFitter fitter(model);
  const auto fit = fitter.fit(image.view(), {.length = 1.2, .width = 0.3, .height = kHeight}, {},
                              {.pose = {truth.x + 0.02, truth.y - 0.015, truth.theta + 0.02}});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->placement.pose.x, truth.x, 1.5e-3);  // 4.5 mm per pixel
  EXPECT_NEAR(fit->placement.pose.y, truth.y, 1.5e-3);
  EXPECT_NEAR(fit->placement.pose.theta, truth.theta, radians(0.05));
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
  const auto fit =
      fitter.fit(image.view(), {.length = 6.0, .width = 0.3, .height = kHeight}, {}, {.pose = {0.0, 0.01, 0.01}});
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->end_visible(kFarEnd));
  EXPECT_FALSE(fit->end_visible(kNearEnd));
  EXPECT_GT(fit->covariance(0, 0), 0.1);
  EXPECT_LT(fit->covariance(1, 1), 1e-5);
}

TEST(OutlineFitter, RefusesAPlaceWithoutEdges) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const GreyImage image = test::draw_ceiling({}, camera, kHeight);
  OutlineFitter fitter(model);
  EXPECT_FALSE(fitter.fit(image.view(), {.length = 1.2, .width = 0.3, .height = kHeight}, {}, {}));
}

/// The test's lamp, seen where it is.
std::optional<OutlineFit> fit_of(const Outline& outline, const test::DrawnShape& drawn) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const GreyImage image = test::draw_ceiling({.shapes = {drawn}}, camera, kHeight);
  OutlineFitter fitter(model);
  return fitter.fit(image.view(), outline, {.side_sigma = 0.03}, {.pose = drawn.pose});
}

TEST(OutlineFitter, SaysHowMuchLongerAndWiderAnOutlineLooksThanItsNominalSize) {
  const auto fit = fit_of({.length = 1.16, .width = 0.28, .height = kHeight}, {.pose = {0.1, 0.05, 0.3}});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->placement.end_outset - fit->placement.side_outset, 0.01, 0.004);
  EXPECT_NEAR(fit->placement.pose.x, 0.1, 1.5e-3);
  EXPECT_NEAR(fit->placement.pose.y, 0.05, 1.5e-3);
}

TEST(OutlineFitter, NamesTheOnlyLongSideInView) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  const auto above = model.point_on_ceiling({320.0, 0.0}, kHeight);
  const Pose2 pose{above->x(), above->y(), 0.5 * kPi};  // half of it above the image
  const auto fit = fit_of({.length = 1.2, .width = 0.3, .height = kHeight}, {.pose = pose});
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->only_side());
  EXPECT_EQ(fit->sides[*fit->only_side()].on_edge, fit->sides[*fit->only_side()].in_view);
}

TEST(EdgeSearch, FindsADarkEdgeBesideADarkerGridLine) {
  const CameraDescription camera = test::test_camera();
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  test::DrawnCeiling ceiling{.joint_depth = 30.0, .noise = 1.0};
  // the line between tiles at y = 0.6 is 30 mm beside its left side
  ceiling.shapes = {{.pose = {0.0, 0.42, 0.0}, .state = DetectionState::kUnlit, .darker = 18.0}};
  const GreyImage image = test::draw_ceiling(ceiling, camera, kHeight);
  EdgeSearch edges(model);
  const Outline outline{.length = 1.2, .width = 0.3, .height = kHeight};
  const EdgeSearchParams params{.inside_brighter = false, .min_edge = 5.0, .pixel_noise = 1.0};
  edges.spread_points(outline, 0.0045, 8.0);
  edges.start({.pose = {0.0, 0.42, 0.0}}, kHeight, params);
  edges.measure(image.view(), params, kLeftSide);
  const auto points = edges.points_of(kLeftSide);
  const auto near = std::count_if(points.begin(), points.end(), [](const EdgePoint& point) {
    return point.found && std::abs(point.offset_px) < 1.0;
  });
  EXPECT_GE(10 * near, 8 * static_cast<std::ptrdiff_t>(points.size()));
}

}  // namespace
}  // namespace luminav
