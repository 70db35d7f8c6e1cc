#include "services/common/geometry/camera_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector2d distort_pinhole(const Vector2d& undistorted, const std::array<double, 5>& k) {
  const double x = undistorted.x();
  const double y = undistorted.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return {x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
          y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y};
}

constexpr double kInverted = 1e-9;  // [focal lengths] that an inverted distortion may be off: a millionth of a pixel

/// d distort_pinhole / d undistorted, which is symmetric.
Eigen::Matrix2d pinhole_slope(const Vector2d& undistorted, const std::array<double, 5>& k) {
  const double x = undistorted.x();
  const double y = undistorted.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double growth = 2.0 * (k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]));
  const double across = growth * x * y + 2.0 * (k[2] * x + k[3] * y);
  Eigen::Matrix2d slope;
  slope << radial + growth * x * x + 2.0 * k[2] * y + 6.0 * k[3] * x, across,  //
      across, radial + growth * y * y + 6.0 * k[2] * y + 2.0 * k[3] * x;
  return slope;
}

/// Inverse of a function that grows from 0 at 0 up to `max`, for a value that it takes there.
template <typename Function>
double inverse_by_halving(double value, double max, const Function& function) {
  double low = 0.0;
  double high = max;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) < value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Inverse of distort_pinhole within `largest_radius`, where that is reached. Fixed-point iteration does for the lenses
/// of webcams; Newton's does for strong ones, from where the radial part alone would have the point.
std::optional<Vector2d> undistort_pinhole(const Vector2d& distorted, const std::array<double, 5>& k,
                                          double largest_radius) {
  Vector2d estimate = distorted;
  Vector2d error = Vector2d::Zero();
  for (int i = 0; i < 20; ++i) {
    error = distort_pinhole(estimate, k) - distorted;
    estimate -= error;
    if (error.squaredNorm() < 1e-20) {
      break;
    }
  }
  if (!(error.norm() < kInverted && estimate.norm() <= largest_radius)) {
    constexpr double kWidest = 20.0;  // [focal lengths] 87 degrees from the axis
    const double radius = distorted.norm();
    const double undistorted = inverse_by_halving(radius, std::min(largest_radius, kWidest), [&](double r) {
      return r * (1.0 + r * r * (k[0] + r * r * (k[1] + r * r * k[4])));
    });
    estimate = distorted * (undistorted / radius);
    for (int i = 0; i < 20; ++i) {
      error = distort_pinhole(estimate, k) - distorted;
      if (error.norm() < kInverted) {
        break;
      }
      estimate -= pinhole_slope(estimate, k).inverse() * error;
    }
  }
  const bool is_inverted = error.norm() < kInverted && estimate.norm() <= largest_radius;
  return is_inverted ? std::optional(estimate) : std::nullopt;
}

double fisheye_radius(double angle, const std::array<double, 5>& k) {
  const double a2 = angle * angle;
  return angle * (1.0 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
}

double fisheye_slope(double angle, const std::array<double, 5>& k) {
  const double a2 = angle * angle;
  return 1.0 + a2 * (3.0 * k[0] + a2 * (5.0 * k[1] + a2 * (7.0 * k[2] + a2 * 9.0 * k[3])));
}

/// Angle from the axis of what is seen at a radius of the image; nothing beyond what is seen at `largest_angle`.
std::optional<double> fisheye_angle(double radius, const std::array<double, 5>& k, double largest_angle) {
  if (radius > fisheye_radius(largest_angle, k)) {
    return std::nullopt;
  }
  double angle = std::min(radius, 0.5 * kPi);
  for (int i = 0; i < 20; ++i) {
    const double slope = fisheye_slope(angle, k);
    const double step = (fisheye_radius(angle, k) - radius) / (std::abs(slope) < 1e-6 ? 1e-6 : slope);
    angle -= step;
    if (std::abs(step) < 1e-12) {
      break;
    }
  }
  // a step from where the curve is flat may lead anywhere
  if (!(angle >= 0.0 && angle <= largest_angle && std::abs(fisheye_radius(angle, k) - radius) < kInverted)) {
    angle = inverse_by_halving(radius, largest_angle, [&](double a) { return fisheye_radius(a, k); });
  }
  return angle;
}

/// Radius at which r * (1 + k1 r^2 + k2 r^4 + k3 r^6) stops growing: points beyond would fold back into the image.
double radius_of_monotony(const std::array<double, 5>& k) {
  for (double r = 0.01; r < 5.0; r += 0.01) {
    const double r2 = r * r;
    if (1.0 + r2 * (3.0 * k[0] + r2 * (5.0 * k[1] + r2 * 7.0 * k[4])) <= 0.0) {
      return r;
    }
  }
  return std::numeric_limits<double>::infinity();
}

/// The angle from the axis [rad] at which a fisheye's radius stops growing, at most straight behind.
double angle_of_monotony(const std::array<double, 5>& k) {
  constexpr double kStep = 0.001;
  double angle = 0.0;
  while (angle + kStep < kPi && fisheye_slope(angle + kStep, k) > 0.0) {
    angle += kStep;
  }
  return angle;
}

/// What `pixel_of_ceiling_point` does, in its order of operations, as a loop that the compiler turns into vectors.
LUMINAV_VECTOR_CLONES
void project_pinhole(const CameraIntrinsics& lens, const CameraMounting& mounting, const Matrix3d& robot_from_camera,
                     double largest_radius, double height, const Vector2d* points, std::size_t count,
                     Vector2d* pixels) {
  const std::array<double, 5> k = lens.distortion;
  const Matrix3d r = robot_from_camera;
  const double oz = height - mounting.z;
  const double mx = mounting.x;
  const double my = mounting.y;
  const double fx = lens.fx;
  const double fy = lens.fy;
  const double cx = lens.cx;
  const double cy = lens.cy;
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const auto* in = reinterpret_cast<const double*>(points);
  auto* out = reinterpret_cast<double*>(pixels);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const double ox = in[2 * i] - mx;
    const double oy = in[2 * i + 1] - my;
    const double px = r(0, 0) * ox + r(1, 0) * oy + r(2, 0) * oz;
    const double py = r(0, 1) * ox + r(1, 1) * oy + r(2, 1) * oz;
    const double pz = r(0, 2) * ox + r(1, 2) * oy + r(2, 2) * oz;
    const double limit = largest_radius * pz;
    const bool seen = (pz > 1e-6) & (px * px + py * py <= limit * limit);
    const double per_z = 1.0 / pz;
    const double x = px * per_z;
    const double y = py * per_z;
    const double r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    const double dx = x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
    const double dy = y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
    out[2 * i] = seen ? fx * dx + cx : nothing;
    out[2 * i + 1] = seen ? fy * dy + cy : nothing;
  }
}

}  // namespace

Matrix3d CameraMounting::rotation() const {
  const double cr = std::cos(roll);
  const double sr = std::sin(roll);
  const double cp = std::cos(pitch);
  const double sp = std::sin(pitch);
  const double cy = std::cos(yaw);
  const double sy = std::sin(yaw);
  Matrix3d yaw_pitch_roll;
  yaw_pitch_roll << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,                //
      -sp, cp * sr, cp * cr;
  Matrix3d looking_up;
  looking_up << 0.0, -1.0, 0.0,  //
      1.0, 0.0, 0.0,             //
      0.0, 0.0, 1.0;
  return yaw_pitch_roll * looking_up;
}

CeilingCamera::CeilingCamera(const CameraIntrinsics& intrinsics, const CameraMounting& mounting)
    : intrinsics_(intrinsics),
      mounting_(mounting),
      robot_from_camera_(mounting.rotation()),
      largest_radius_(radius_of_monotony(intrinsics.distortion)),
      largest_angle_(intrinsics.model == LensModel::kFisheye ? angle_of_monotony(intrinsics.distortion) : kPi) {}

std::optional<Vector3d> CeilingCamera::ray_in_camera(const Vector2d& pixel) const {
  const Vector2d distorted((pixel.x() - intrinsics_.cx) / intrinsics_.fx,
                           (pixel.y() - intrinsics_.cy) / intrinsics_.fy);
  if (intrinsics_.model == LensModel::kPinhole) {
    const auto undistorted = undistort_pinhole(distorted, intrinsics_.distortion, largest_radius_);
    return undistorted ? std::optional(Vector3d(undistorted->x(), undistorted->y(), 1.0).normalized()) : std::nullopt;
  }
  const double radius = distorted.norm();
  if (radius < 1e-12) {
    return Vector3d(0.0, 0.0, 1.0);
  }
  const auto angle = fisheye_angle(radius, intrinsics_.distortion, largest_angle_);
  if (!angle) {
    return std::nullopt;
  }
  const Vector2d direction = distorted / radius * std::sin(*angle);
  return Vector3d(direction.x(), direction.y(), std::cos(*angle));
}

std::optional<Vector2d> CeilingCamera::pixel_of(const Vector3d& point_in_camera) const {
  Vector2d distorted;
  if (intrinsics_.model == LensModel::kPinhole) {
    if (point_in_camera.z() <= 1e-6 ||
        point_in_camera.head<2>().squaredNorm() > std::pow(largest_radius_ * point_in_camera.z(), 2)) {
      return std::nullopt;
    }
    distorted = distort_pinhole(point_in_camera.head<2>() * (1.0 / point_in_camera.z()), intrinsics_.distortion);
  } else {
    const double planar = point_in_camera.head<2>().norm();
    const double angle = std::atan2(planar, point_in_camera.z());
    if (angle > largest_angle_) {
      return std::nullopt;
    }
    const double scale = planar < 1e-12 ? 0.0 : fisheye_radius(angle, intrinsics_.distortion) / planar;
    distorted = {point_in_camera.x() * scale, point_in_camera.y() * scale};
  }
  return Vector2d(intrinsics_.fx * distorted.x() + intrinsics_.cx, intrinsics_.fy * distorted.y() + intrinsics_.cy);
}

std::optional<Vector2d> CeilingCamera::point_on_ceiling(const Vector2d& pixel, double height) const {
  const auto ray_in_camera = this->ray_in_camera(pixel);
  if (!ray_in_camera) {
    return std::nullopt;
  }
  const Vector3d ray = robot_from_camera_ * *ray_in_camera;
  if (ray.z() <= 1e-3) {
    return std::nullopt;
  }
  const double length = (height - mounting_.z) / ray.z();
  return Vector2d(mounting_.x + length * ray.x(), mounting_.y + length * ray.y());
}

std::optional<Vector2d> CeilingCamera::pixel_of_ceiling_point(const Vector2d& point_in_robot, double height) const {
  const Vector3d offset(point_in_robot.x() - mounting_.x, point_in_robot.y() - mounting_.y, height - mounting_.z);
  return pixel_of(robot_from_camera_.transpose() * offset);
}

void CeilingCamera::pixels_of_ceiling_points(std::span<const Vector2d> points, double height,
                                             std::span<Vector2d> pixels) const {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  if (intrinsics_.model == LensModel::kPinhole) {
    project_pinhole(intrinsics_, mounting_, robot_from_camera_, largest_radius_, height, points.data(), points.size(),
                    pixels.data());
    return;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    pixels[i] = pixel_of_ceiling_point(points[i], height).value_or(Vector2d(nothing, nothing));
  }
}

}  // namespace luminav
