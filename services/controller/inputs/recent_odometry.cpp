#include "services/controller/inputs/recent_odometry.hpp"

#include <algorithm>
#include <iterator>

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kKept = 1'500'000;       // [us]
constexpr std::int64_t kTooFarAhead = 200'000;  // [us] motion is not extrapolated further

}  // namespace

void RecentOdometry::add(const odometry_t& message) {
  began_ = messages_.empty() ? message.utime : began_;
  messages_.push_back(message);
  while (messages_.front().utime < message.utime - kKept) {
    messages_.pop_front();
  }
}

bool RecentOdometry::is_too_far_ahead(std::int64_t utime) const {
  return utime > newest().utime + kTooFarAhead;
}

std::optional<Pose2> RecentOdometry::odom_from_robot_at(std::int64_t utime) const {
  if (messages_.empty() || utime < messages_.front().utime - kTooFarAhead) {
    return std::nullopt;
  }
  const odometry_t& newest = messages_.back();
  if (utime >= newest.utime) {
    const double ahead = seconds_between(newest.utime, std::min(utime, newest.utime + kTooFarAhead));
    return odom_from_robot(newest) * drive_arc({newest.linear, newest.angular}, ahead);
  }
  const auto after =
      std::find_if(messages_.begin(), messages_.end(), [utime](const odometry_t& o) { return o.utime >= utime; });
  if (after == messages_.begin()) {
    return odom_from_robot(*after);
  }
  const auto before = std::prev(after);
  const double fraction =
      static_cast<double>(utime - before->utime) / static_cast<double>(after->utime - before->utime);
  return interpolate(odom_from_robot(*before), odom_from_robot(*after), fraction);
}

}  // namespace luminav
