#include "services/surveyor/drive/pose_at.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr double kReach = 1.0;  // [m] key frames are 0.1 m apart where there are images

/// The last reading up to a time, or the first of all.
std::vector<OdometryReading>::const_iterator reading_at(const std::vector<OdometryReading>& odometry,
                                                        std::int64_t utime) {
  const auto behind =
      std::upper_bound(odometry.begin(), odometry.end(), utime,
                       [](std::int64_t time, const OdometryReading& reading) { return time < reading.utime; });
  return behind == odometry.begin() ? behind : behind - 1;
}

}  // namespace

std::optional<Pose2> pose_at(const std::vector<KeyFrame>& frames, const std::vector<Pose2>& poses,
                             const std::vector<OdometryReading>& odometry, std::int64_t utime) {
  if (odometry.empty() || frames.empty()) {
    return std::nullopt;
  }
  const auto reading = reading_at(odometry, utime);
  const auto behind = std::upper_bound(frames.begin(), frames.end(), reading->utime,
                                       [](std::int64_t time, const KeyFrame& frame) { return time < frame.utime; });
  const auto frame = behind == frames.begin() ? behind : behind - 1;
  const Pose2 since = frame->odom_from_robot.inverse() * reading->odom_from_robot;
  if (reading_at(odometry, frame->utime)->session != reading->session || since.position().norm() > kReach) {
    return std::nullopt;
  }
  return poses[static_cast<std::size_t>(frame - frames.begin())] * since;
}

}  // namespace luminav
