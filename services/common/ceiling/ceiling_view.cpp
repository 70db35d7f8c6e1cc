#include "services/common/ceiling/ceiling_view.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr int kAlong = 8;  // sample points of a fixture
constexpr int kAcross = 2;
constexpr double kFarthest = 1.73;  // [m] per metre of height, 60 degrees off the zenith: beyond a fixture is a sliver
constexpr int kBorderPoints = 48;   // of a view that the image's corners do not bound

/// Sample points of a fixture, in the robot frame.
class FixtureSamples {
 public:
  FixtureSamples(const Pose2& robot_from_fixture, const Fixture& fixture)
      : robot_from_fixture_(robot_from_fixture), fixture_(fixture) {}

  [[nodiscard]] Eigen::Vector2d at(int along, int across) const {
    return robot_from_fixture_ * Eigen::Vector2d(fixture_.length * ((along + 0.5) / kAlong - 0.5),
                                                 fixture_.width * ((across + 0.5) / kAcross - 0.5));
  }

 private:
  PointTransform robot_from_fixture_;
  const Fixture& fixture_;
};

/// Of a polygon; negative where its corners go clockwise.
double doubled_area(const std::vector<Eigen::Vector2d>& corners) {
  double area = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area;
}

}  // namespace

CeilingView::CeilingView(const CameraDescription& camera)
    : camera_(camera), model_(camera.intrinsics, camera.mounting) {
  const Eigen::Vector2d mounting(camera.mounting.x, camera.mounting.y);
  const double right = camera.intrinsics.width - 1.0;
  const double bottom = camera.intrinsics.height - 1.0;
  // the corners alone: between them lens distortion bends the sides by less than the margins used
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(right, 0.0),
                                       Eigen::Vector2d(right, bottom), Eigen::Vector2d(0.0, bottom)}) {
    const auto point = model_.point_on_ceiling(pixel, camera.mounting.z + 1.0);
    if (point && (*point - mounting).norm() < 2.0 * kFarthest) {
      border_.push_back(*point - mounting);
    }
  }
  if (border_.size() < 4) {
    border_ = wide_border();
  }
  if (doubled_area(border_) < 0.0) {
    std::reverse(border_.begin(), border_.end());
  }
  for (std::size_t i = 0; i < border_.size(); ++i) {
    sides_.push_back({border_[i], (border_[(i + 1) % border_.size()] - border_[i]).normalized()});
  }
}

bool CeilingView::is_inside(const Eigen::Vector2d& point, double height, double margin) const {
  const Eigen::Vector2d on_unit_plane = (point - Eigen::Vector2d(camera_.mounting.x, camera_.mounting.y)) / height;
  return std::all_of(sides_.begin(), sides_.end(), [&](const Side& side) {
    const Eigen::Vector2d offset = on_unit_plane - side.start;
    return (side.along.x() * offset.y() - side.along.y() * offset.x()) * height >= margin;
  });
}

// Of a fisheye, whose corners look at walls: as far as each direction is in the image, up to the bound.
std::vector<Eigen::Vector2d> CeilingView::wide_border() const {
  const Eigen::Vector2d mounting(camera_.mounting.x, camera_.mounting.y);
  std::vector<Eigen::Vector2d> border;
  for (int i = 0; i < kBorderPoints; ++i) {
    const double azimuth = 2.0 * kPi * i / kBorderPoints;
    const Eigen::Vector2d along(std::cos(azimuth), std::sin(azimuth));
    double inside = 0.0;
    double outside = kFarthest;
    for (int halving = 0; halving < 12; ++halving) {
      const double middle = 0.5 * (inside + outside);
      const auto pixel = model_.pixel_of_ceiling_point(mounting + middle * along, camera_.mounting.z + 1.0);
      (pixel && model_.is_in_image(*pixel) ? inside : outside) = middle;
    }
    border.push_back(inside * along);
  }
  return border;
}

double CeilingView::visible_share(const Pose2& robot_from_fixture, const Fixture& fixture, double margin) const {
  const double height = height_above_camera(fixture.height);
  if (height <= 0.1 || border_.size() < 3) {
    return 0.0;
  }
  const FixtureSamples samples(robot_from_fixture, fixture);
  int inside = 0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      inside += is_inside(samples.at(i, j), height, margin) ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kAlong * kAcross);
}

bool CeilingView::is_wholly_visible(const Pose2& robot_from_fixture, const Fixture& fixture, double margin) const {
  const double height = height_above_camera(fixture.height);
  if (height <= 0.1 || border_.size() < 3) {
    return false;
  }
  // Most are out of sight: the centre lies between the samples, and the view is convex.
  constexpr double kRounding = 1e-9;
  if (!is_inside(robot_from_fixture.position(), height, margin - kRounding)) {
    return false;
  }
  const FixtureSamples samples(robot_from_fixture, fixture);
  const auto all_inside = [&](int i) {
    return is_inside(samples.at(i, 0), height, margin) && is_inside(samples.at(i, kAcross - 1), height, margin);
  };
  if (!all_inside(0) || !all_inside(kAlong - 1)) {
    return false;  // most often an end is out of sight
  }
  for (int i = 1; i + 1 < kAlong; ++i) {
    if (!all_inside(i)) {
      return false;
    }
  }
  return true;
}

double CeilingView::radius(double height) const {
  double radius = 0.0;
  for (const Eigen::Vector2d& corner : border_) {
    radius = std::max(radius, corner.norm());
  }
  return radius * std::max(0.0, height_above_camera(height)) + std::hypot(camera_.mounting.x, camera_.mounting.y);
}

double CeilingView::mean_radius(double height) const {
  return std::max(0.0, height_above_camera(height)) * std::sqrt(0.5 * doubled_area(border_) / kPi);
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
