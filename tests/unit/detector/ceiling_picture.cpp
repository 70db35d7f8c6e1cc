#include "tests/unit/detector/ceiling_picture.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace luminav::test {
namespace {

double signed_distance(const DrawnShape& shape, const Eigen::Vector2d& local) {
  if (shape.shape == FixtureShape::kRound) {
    return local.norm() - 0.5 * shape.length;
  }
  const double dx = std::abs(local.x()) - 0.5 * shape.length;
  const double dy = std::abs(local.y()) - 0.5 * shape.width;
  return std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) + std::min(std::max(dx, dy), 0.0);
}

double distance_to_joint(double position) {
  constexpr double kTile = 0.6;  // [m]
  return std::abs(position - kTile * std::round(position / kTile));
}

}  // namespace

GreyImage draw_ceiling(const DrawnCeiling& ceiling, const CameraDescription& camera, double height) {
  const CeilingCamera model(camera.intrinsics, camera.mounting);
  GreyImage image{camera.intrinsics.width, camera.intrinsics.height, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::mt19937 rng(ceiling.seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<Pose2> shape_from_robot;
  for (const DrawnShape& shape : ceiling.shapes) {
    shape_from_robot.push_back(shape.pose.inverse());
  }
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto point = model.point_on_ceiling({x, y}, height);
      double grey = 0.0;
      if (point) {
        grey = ceiling.grey + ceiling.slope_x * point->x() + ceiling.slope_y * point->y();
        const double tile = grey;
        if (std::min(distance_to_joint(point->x() + 0.13), distance_to_joint(point->y() + 0.21)) < 0.006) {
          grey -= ceiling.joint_depth;
        }
        for (std::size_t i = 0; i < ceiling.shapes.size(); ++i) {
          const DrawnShape& shape = ceiling.shapes[i];
          const Eigen::Vector2d local = shape_from_robot[i] * *point;
          const double outside = signed_distance(shape, local);
          const double covered = 0.5 * std::erfc(outside / (std::sqrt(2.0) * ceiling.blur));
          double inside = tile - shape.darker;  // it covers the joints
          if (outside < -0.03) {
            inside += shape.slats * std::cos(2.0 * kPi * local.y() / 0.05);
          }
          double glow = 0.0;
          if (shape.state == DetectionState::kLit) {
            inside = ceiling.lamp;
            glow = ceiling.bloom * std::exp(-std::max(outside, 0.0) / ceiling.bloom_reach);
          } else if (shape.state == DetectionState::kHalf && local.y() > 0.0) {
            inside = ceiling.lamp;
          }
          const double beside_half = std::max({outside, -local.y(), 0.0});
          grey = covered * inside + (1.0 - covered) * (grey + glow) +
                 shape.half_bloom * std::exp(-beside_half / ceiling.bloom_reach);
        }
      }
      grey += ceiling.noise * noise(rng);
      image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L)));
    }
  }
  return image;
}

CameraDescription test_camera() {
  CameraDescription camera;
  camera.intrinsics.distortion = {-0.1, 0.02, 0.0, 0.0, 0.0};
  camera.mounting.x = 0.05;
  camera.mounting.z = 0.30;
  camera.mounting.roll = 0.01;
  camera.mounting.pitch = -0.015;
  camera.mounting.yaw = 0.02;
  return camera;
}

CeilingCatalogue test_catalogue() {
  CeilingCatalogue catalogue;
  catalogue.ceiling_height = 2.8;
  catalogue.fixtures = {{.length = 1.2, .width = 0.3, .height = 2.8, .lamps = 2},
                        {.length = 1.2, .width = 0.15, .height = 2.8, .lamps = 1}};
  catalogue.elements = {
      {.shape = FixtureShape::kSquare, .length = 0.6, .width = 0.6, .height = 2.8, .lamps = 0, .luminous = false},
      {.length = 0.6, .width = 0.3, .height = 2.8, .lamps = 0, .luminous = false},
      {.shape = FixtureShape::kRound, .length = 0.12, .width = 0.12, .height = 2.8, .lamps = 0, .luminous = false}};
  return catalogue;
}

}  // namespace luminav::test
