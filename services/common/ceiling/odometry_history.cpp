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
  while (readings_.size() > 2 && readings_.front().utime < reading.utime - kSpan) {
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

}  // namespace luminav
