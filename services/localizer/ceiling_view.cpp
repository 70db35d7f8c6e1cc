#include "services/localizer/ceiling_view.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr int kAlong = 8;  // sample points of a fixture
constexpr int kAcross = 2;

/// Signed distance of a point to the nearest side of a convex polygon, positive inside.
double depth_inside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point) {
  double depth = 1e9;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d side = (polygon[(i + 1) % polygon.size()] - a).normalized();
    const Eigen::Vector2d offset = point - a;
    depth = std::min(depth, side.x() * offset.y() - side.y() * offset.x());
  }
  return depth;
}

}  // namespace

CeilingView::CeilingView(const CameraDescription& camera)
    : camera_(camera), model_(camera.intrinsics, camera.mounting) {
  const double right = camera.intrinsics.width - 1.0;
  const double bottom = camera.intrinsics.height - 1.0;
  // the corners alone: between them lens distortion bends the sides by less than the margins used
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(right, 0.0),
                                       Eigen::Vector2d(right, bottom), Eigen::Vector2d(0.0, bottom)}) {
    const auto point = model_.point_on_ceiling(pixel, camera.mounting.z + 1.0);
    if (point) {
      border_.push_back(*point - Eigen::Vector2d(camera.mounting.x, camera.mounting.y));
    }
  }
  double area = 0.0;
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const Eigen::Vector2d& a = border_[i];
    const Eigen::Vector2d& b = border_[(i + 1) % border_.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  if (area < 0.0) {
    std::reverse(border_.begin(), border_.end());
  }
}

double CeilingView::visible_share(const Pose2& robot_from_fixture, const Fixture& fixture, double margin) const {
  const double height = height_above_camera(fixture.height);
  if (height <= 0.1 || border_.size() < 3) {
    return 0.0;
  }
  const Eigen::Vector2d mounting(camera_.mounting.x, camera_.mounting.y);
  int inside = 0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const Eigen::Vector2d on_fixture(fixture.length * ((i + 0.5) / kAlong - 0.5),
                                       fixture.width * ((j + 0.5) / kAcross - 0.5));
      const Eigen::Vector2d on_unit_plane = (robot_from_fixture * on_fixture - mounting) / height;
      inside += depth_inside(border_, on_unit_plane) * height >= margin ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kAlong * kAcross);
}

double CeilingView::radius(double height) const {
  double radius = 0.0;
  for (const Eigen::Vector2d& corner : border_) {
    radius = std::max(radius, corner.norm());
  }
  return radius * std::max(0.0, height_above_camera(height)) + std::hypot(camera_.mounting.x, camera_.mounting.y);
}

double CeilingView::mean_radius(double height) const {
  double doubled = 0.0;
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const Eigen::Vector2d& a = border_[i];
    const Eigen::Vector2d& b = border_[(i + 1) % border_.size()];
    doubled += a.x() * b.y() - a.y() * b.x();
  }
  return std::max(0.0, height_above_camera(height)) * std::sqrt(0.5 * doubled / kPi);
}

Eigen::Vector2d CeilingView::at_middle_row(const Eigen::Vector2d& point, double height, double linear,
                                           double angular) const {
  const auto pixel = model_.pixel_of_ceiling_point(point, height);
  if (!pixel) {
    return point;
  }
  const double late = (pixel->y() - 0.5 * (camera_.intrinsics.height - 1)) * camera_.row_time;
  // undo what the point moved in the robot frame between the middle row's reading and its own
  return point - late * Eigen::Vector2d(-linear + angular * point.y(), -angular * point.x());
}

FixtureSighting CeilingView::without_rolling_shutter(const FixtureSighting& sighting, double height, double linear,
                                                     double angular) const {
  if (camera_.row_time == 0.0 || height_above_camera(height) <= 0.1) {
    return sighting;
  }
  FixtureSighting corrected = sighting;
  const Eigen::Vector2d centre = sighting.robot_from_fixture.position();
  const Eigen::Vector2d half =
      0.5 * std::max(sighting.length, 0.1) *
      Eigen::Vector2d(std::cos(sighting.robot_from_fixture.theta), std::sin(sighting.robot_from_fixture.theta));
  const Eigen::Vector2d far = at_middle_row(centre + half, height, linear, angular);
  const Eigen::Vector2d near = at_middle_row(centre - half, height, linear, angular);
  const Eigen::Vector2d middle = at_middle_row(centre, height, linear, angular);
  corrected.robot_from_fixture.x = middle.x();
  corrected.robot_from_fixture.y = middle.y();
  corrected.robot_from_fixture.theta = std::atan2(far.y() - near.y(), far.x() - near.x());
  if (!sighting.clipped) {
    corrected.length = (far - near).norm();  // the rows that are read later saw their end of it from farther on
  }
  return corrected;
}

}  // namespace luminav
