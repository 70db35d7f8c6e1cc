#include "services/common/geometry/camera_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

CameraIntrinsics webcam() {
  CameraIntrinsics lens;
  lens.distortion = {-0.1, 0.02, 0.001, -0.0005, 0.0};
  return lens;
}

TEST(CeilingCamera, LooksStraightUpWithItsTopToTheFront) {
  const CeilingCamera camera(CameraIntrinsics{}, CameraMounting{0.1, 0.0, 0.3, 0.0, 0.0, 0.0});
  const auto centre = camera.pixel_of_ceiling_point({0.1, 0.0}, 2.8);
  ASSERT_TRUE(centre);
  EXPECT_NEAR(centre->x(), 319.5, 1e-9);
  EXPECT_NEAR(centre->y(), 239.5, 1e-9);
  // 2.5 m above the camera a metre is 554 / 2.5 px: forward is up in the image, left is right
  const auto ahead = camera.pixel_of_ceiling_point({1.1, 0.0}, 2.8);
  EXPECT_NEAR(ahead->y(), 239.5 - 221.6, 1e-9);
  const auto left = camera.pixel_of_ceiling_point({0.1, 1.0}, 2.8);
  EXPECT_NEAR(left->x(), 319.5 + 221.6, 1e-9);
}

TEST(CeilingCamera, PitchedForwardSeesFartherAhead) {
  // a positive pitch about y (left) turns the view axis from up towards the front
  const CeilingCamera camera(CameraIntrinsics{}, CameraMounting{0.0, 0.0, 0.3, 0.0, radians(10.0), 0.0});
  const auto seen = camera.point_on_ceiling({319.5, 239.5}, 2.8);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->x(), 2.5 * std::tan(radians(10.0)), 1e-9);
  EXPECT_NEAR(seen->y(), 0.0, 1e-9);
}

TEST(CeilingCamera, ProjectsBackToTheSamePixel) {
  CameraIntrinsics fisheye;
  fisheye.model = LensModel::kFisheye;
  fisheye.fx = fisheye.fy = 250.0;
  fisheye.distortion = {0.05, -0.01, 0.002, 0.0, 0.0};
  const CameraMounting mounting{0.05, -0.02, 0.35, 0.02, -0.03, 0.4};
  for (const CameraIntrinsics& lens : {CameraIntrinsics{}, webcam(), fisheye}) {
    const CeilingCamera camera(lens, mounting);
    for (double x = 5.0; x < 640.0; x += 45.0) {
      for (double y = 5.0; y < 480.0; y += 45.0) {
        const auto point = camera.point_on_ceiling({x, y}, 2.8);
        ASSERT_TRUE(point);
        const auto pixel = camera.pixel_of_ceiling_point(*point, 2.8);
        ASSERT_TRUE(pixel);
        EXPECT_NEAR(pixel->x(), x, 1e-5);
        EXPECT_NEAR(pixel->y(), y, 1e-5);
      }
    }
  }
}

TEST(CeilingCamera, DoesNotFoldFarPointsBackIntoTheImage) {
  CameraIntrinsics barrel;
  barrel.distortion = {-0.3, 0.0, 0.0, 0.0, 0.0};
  const CeilingCamera camera(barrel, CameraMounting{});
  EXPECT_FALSE(camera.pixel_of({3.0, 0.0, 1.0}));
  EXPECT_FALSE(camera.pixel_of({0.0, 0.0, -1.0}));
}

TEST(CeilingCamera, IsTheSameBothWaysOrSaysThatItCannot) {
  const auto lens_of = [](LensModel model, double focal, const std::array<double, 5>& distortion) {
    CameraIntrinsics lens;
    lens.model = model;
    lens.fx = lens.fy = focal;
    lens.distortion = distortion;
    return lens;
  };
  struct Strong {
    CameraIntrinsics lens;
    bool covers_all;
  };
  const Strong strong[] = {
      {lens_of(LensModel::kPinhole, 300.0, {0.3, 0.0, 0.0, 0.0, 0.0}), true},
      {lens_of(LensModel::kPinhole, 300.0, {0.5, 0.1, 0.002, -0.003, 0.0}), true},
      {lens_of(LensModel::kPinhole, 300.0, {-0.4, 0.0, 0.001, 0.0, 0.0}), false},
      {lens_of(LensModel::kFisheye, 250.0, {-0.2, 0.0, 0.0, 0.0, 0.0}), false},
      {lens_of(LensModel::kFisheye, 250.0, {0.03, -0.05, 0.01, -0.004, 0.0}), false},
  };
  for (const Strong& one : strong) {
    SCOPED_TRACE(one.lens.distortion[0]);
    const CeilingCamera camera(one.lens, CameraMounting{});
    int covered = 0;
    int left_out = 0;
    for (double x = 0.0; x < 640.0; x += 7.0) {
      for (double y = 0.0; y < 480.0; y += 7.0) {
        const auto ray = camera.ray_in_camera({x, y});
        if (!ray) {
          ++left_out;
          EXPECT_FALSE(camera.point_on_ceiling({x, y}, 2.8));
          continue;
        }
        ++covered;
        ASSERT_TRUE(ray->allFinite());
        const auto pixel = camera.pixel_of(*ray);
        ASSERT_TRUE(pixel) << x << " " << y;
        EXPECT_NEAR((*pixel - Eigen::Vector2d(x, y)).norm(), 0.0, 1e-5);
      }
    }
    EXPECT_GT(covered, 2000);
    EXPECT_EQ(left_out == 0, one.covers_all);
  }
}

TEST(CeilingCamera, DoesNotFoldAFisheyesFarPointsBack) {
  CameraIntrinsics fisheye;
  fisheye.model = LensModel::kFisheye;
  fisheye.fx = fisheye.fy = 250.0;
  fisheye.distortion = {-0.2, 0.0, 0.0, 0.0, 0.0};  // its radius grows up to 74 degrees
  const CeilingCamera camera(fisheye, CameraMounting{});
  EXPECT_TRUE(camera.pixel_of({6.0, 0.0, 2.0}));
  EXPECT_FALSE(camera.pixel_of({8.0, 0.0, 2.0}));
  EXPECT_FALSE(camera.pixel_of({20.0, 0.0, 2.0}));
}

TEST(CeilingCamera, TakesManyPointsAsItTakesOne) {
  CameraIntrinsics fisheye;
  fisheye.model = LensModel::kFisheye;
  for (const CameraIntrinsics& lens : {webcam(), fisheye}) {
    const CeilingCamera camera(lens, CameraMounting{0.1, -0.05, 0.3, 0.02, -0.03, 0.7});
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 101; ++i) {
      points.emplace_back(20.0 * std::sin(i), 3.0 * std::cos(3.7 * i));
    }
    std::vector<Eigen::Vector2d> pixels(points.size());
    camera.pixels_of_ceiling_points(points, 2.8, pixels);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto one = camera.pixel_of_ceiling_point(points[i], 2.8);
      EXPECT_EQ(one.has_value(), pixels[i].allFinite());
      if (one) {
        EXPECT_EQ(*one, pixels[i]);  // to the last bit
      }
    }
  }
}

TEST(CeilingCamera, KnowsItsBorder) {
  const CeilingCamera camera(CameraIntrinsics{}, CameraMounting{});
  EXPECT_TRUE(camera.is_in_image({0.0, 0.0}));
  EXPECT_TRUE(camera.is_in_image({639.0, 479.0}));
  EXPECT_FALSE(camera.is_in_image({639.5, 10.0}));
  EXPECT_FALSE(camera.is_in_image({1.0, 100.0}, 2.0));
}

}  // namespace
}  // namespace luminav
