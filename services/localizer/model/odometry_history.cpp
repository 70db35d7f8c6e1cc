#include "services/localizer/model/odometry_history.hpp"

#include <algorithm>

namespace luminav {

void OdometryHistory::add(const OdometryReading& reading) {
  if (!readings_.empty() && readings_.back().session != reading.session) {
    readings_.clear();
  }
  readings_.push_back(reading);
  while (readings_.size() > 2 && readings_.front().utime < reading.utime - span_us_) {
    readings_.pop_front();
  }
}

std::optional<OdometryReading> OdometryHistory::at(std::int64_t utime) const {
  if (readings_.empty() || utime < readings_.front().utime || utime > readings_.back().utime) {
    return std::nullopt;
  }
  const auto after = std::lower_bound(readings_.begin(), readings_.end(), utime,
                                      [](const OdometryReading& r, std::int64_t t) { return r.utime < t; });
  if (after->utime == utime || after == readings_.begin()) {
    return *after;
  }
  const OdometryReading& a = *(after - 1);
  const OdometryReading& b = *after;
  const double fraction = static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  OdometryReading result = a;
  result.utime = utime;
  result.odom_from_robot = interpolate(a.odom_from_robot, b.odom_from_robot, fraction);
  result.linear = a.linear + fraction * (b.linear - a.linear);
  result.angular = a.angular + fraction * (b.angular - a.angular);
  return result;
}

OdometryHistory::Travel OdometryHistory::travel(std::int64_t from_utime, std::int64_t to_utime) const {
  Travel travel;
  const auto from = at(from_utime);
  const auto to = at(to_utime);
  if (!from || !to) {
    return travel;
  }
  Pose2 last = from->odom_from_robot;
  const auto add = [&](const Pose2& pose) {
    travel.distance += distance(last, pose);
    travel.turn += std::abs(wrap_angle(pose.theta - last.theta));
    last = pose;
  };
  for (const OdometryReading& reading : readings_) {
    if (reading.utime > from_utime && reading.utime < to_utime) {
      add(reading.odom_from_robot);
    }
  }
  add(to->odom_from_robot);
  return travel;
}

}  // namespace luminav
