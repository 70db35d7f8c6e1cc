#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

namespace luminav {

enum class LensModel { kPinhole, kFisheye };

/// Lens and sensor. Pinhole: radial-tangential distortion k1 k2 p1 p2 k3 as in OpenCV. Fisheye: equidistant with
/// k1 k2 k3 k4 (the fifth unused), Kannala and Brandt 2006.
struct CameraIntrinsics {
  LensModel model = LensModel::kPinhole;
  int width = 640;                     // [px]
  int height = 480;                    // [px]
  double fx = 554.0;                   // [px]
  double fy = 554.0;                   // [px]
  double cx = 319.5;                   // [px]
  double cy = 239.5;                   // [px]
  std::array<double, 5> distortion{};  // see above

  bool operator==(const CameraIntrinsics&) const = default;
};

/// Where the camera sits: robot_from_camera. With roll = pitch = yaw = 0 it looks straight up and the top of its
/// image points to the robot's front (so image right is the robot's left).
struct CameraMounting {
  double x = 0.0;      // [m] robot frame
  double y = 0.0;      // [m] robot frame
  double z = 0.8;      // [m] above the floor
  double roll = 0.0;   // [rad] about the robot's x
  double pitch = 0.0;  // [rad] about the robot's y
  double yaw = 0.0;    // [rad] about the robot's z

  /// Columns are the camera's x, y and z axes in the robot frame.
  [[nodiscard]] Eigen::Matrix3d rotation() const;
  bool operator==(const CameraMounting&) const = default;
};

/// Maps between pixels and points on a horizontal ceiling, both in the robot's terms. Integer pixel coordinates are
/// the centres of pixels.
class CeilingCamera {
 public:
  CeilingCamera(const CameraIntrinsics& intrinsics, const CameraMounting& mounting);

  /// Direction of view through a pixel, camera frame, of length 1; nothing for pixels that the lens model does not
  /// reach.
  [[nodiscard]] std::optional<Eigen::Vector3d> ray_in_camera(const Eigen::Vector2d& pixel) const;
  /// Pixel of a point in the camera frame; nothing when it lies behind the lens or beyond what the lens model covers.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point_in_camera) const;

  /// Point (robot frame, x and y) of a horizontal plane `height` [m] above the floor that a pixel sees; nothing when
  /// the ray does not rise to it, or the lens model does not reach the pixel.
  [[nodiscard]] std::optional<Eigen::Vector2d> point_on_ceiling(const Eigen::Vector2d& pixel, double height) const;
  /// Pixel that sees a point of the robot frame, `height` [m] above the floor; it may lie outside the image.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of_ceiling_point(const Eigen::Vector2d& point_in_robot,
                                                                      double height) const;
  /// Pixels of many points, one after the other, with the same results to the last bit; not a number where there is no
  /// pixel.
  void pixels_of_ceiling_points(std::span<const Eigen::Vector2d> points, double height,
                                std::span<Eigen::Vector2d> pixels) const;
  /// True for pixels inside the image with at least `margin` [px] to its border.
  [[nodiscard]] bool is_in_image(const Eigen::Vector2d& pixel, double margin = 0.0) const {
    return pixel.x() >= margin && pixel.y() >= margin && pixel.x() <= intrinsics_.width - 1 - margin &&
           pixel.y() <= intrinsics_.height - 1 - margin;
  }

  [[nodiscard]] const CameraIntrinsics& intrinsics() const { return intrinsics_; }
  [[nodiscard]] const CameraMounting& mounting() const { return mounting_; }
  /// Rotation robot_from_camera.
  [[nodiscard]] const Eigen::Matrix3d& rotation() const { return robot_from_camera_; }

 private:
  CameraIntrinsics intrinsics_;
  CameraMounting mounting_;
  Eigen::Matrix3d robot_from_camera_;
  // beyond these the model folds back into the image
  double largest_radius_;  // undistorted, in focal lengths, of a pinhole's
  double largest_angle_;   // [rad] from the axis, of a fisheye's
};

}  // namespace luminav
