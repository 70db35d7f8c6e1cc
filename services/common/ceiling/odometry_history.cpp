#include "services/common/ceiling/odometry_history.hpp"

#include <algorithm>

namespace luminav {

OdometryReading interpolate(const OdometryReading& before, const OdometryReading& after, std::int64_t utime) {
  const double share = static_cast<double>(utime - before.utime) / static_cast<double>(after.utime - before.utime);
  OdometryReading at = before;
  at.utime = utime;
  at.odom_from_robot = interpolate(before.odom_from_robot, after.odom_from_robot, share);
  at.linear = before.linear + share * (after.linear - before.linear);
  at.angular = before.angular + share * (after.angular - before.angular);
  return at;
}

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
  return interpolate(*(after - 1), *after, utime);
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
