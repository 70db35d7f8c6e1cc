#include "drivers/camera/simulated/view.hpp"

#include <algorithm>
#include <cmath>

namespace luminav::simulated {

using Eigen::Vector2d;
using Eigen::Vector3d;

View view_from(const CameraMounting& mounting, const TruePose& pose) {
  // The same convention as the mounting's: yaw after pitch after roll.
  const double cr = std::cos(pose.roll);
  const double sr = std::sin(pose.roll);
  const double cp = std::cos(pose.pitch);
  const double sp = std::sin(pose.pitch);
  const double c = std::cos(pose.world_from_robot.theta);
  const double s = std::sin(pose.world_from_robot.theta);
  View view;
  view.world_from_robot << c * cp, c * sp * sr - s * cr, c * sp * cr + s * sr,  //
      s * cp, s * sp * sr + c * cr, s * sp * cr - c * sr,                       //
      -sp, cp * sr, cp * cr;
  view.lens = view.world_from_robot * Vector3d(mounting.x, mounting.y, mounting.z);
  view.lens.x() += pose.world_from_robot.x;
  view.lens.y() += pose.world_from_robot.y;
  return view;
}

FrameGeometry geometry_of(const CeilingModel& model, const Exposure& exposure, const TruePose& middle, double reach) {
  FrameGeometry frame;
  frame.view = view_from(model.mounting, middle);
  frame.origin = frame.view.lens.head<2>();
  frame.reach = reach;
  frame.rise = std::max(0.1, model.building.ceiling_height - frame.view.lens.z());
  const double seconds = 1e-6 * exposure.exposure_us;
  const Vector2d lever = frame.origin - middle.world_from_robot.position();
  frame.turn = exposure.angular * seconds;
  frame.motion = exposure.velocity * seconds + frame.turn * Vector2d(-lever.y(), lever.x());
  const double half_frame = 0.5e-6 * exposure.row_time_us * model.intrinsics.height + 0.5 * seconds;
  const double fastest = exposure.velocity.norm() + std::abs(exposure.angular) * (reach * frame.rise + lever.norm());
  frame.slack = 0.01 + half_frame * fastest;
  return frame;
}

double metres_per_pixel(const CeilingModel& model, const FrameGeometry& frame, const Vector2d& point, double height) {
  const double rise = std::max(0.05, height - frame.view.lens.z());
  const double tangent = std::min((point - frame.origin).norm() / rise, frame.reach);
  // Between the footprint's two axes, rise / (f cos) and rise / (f cos^2).
  return rise / model.intrinsics.fx * std::pow(1.0 + tangent * tangent, 0.75);
}

}  // namespace luminav::simulated
