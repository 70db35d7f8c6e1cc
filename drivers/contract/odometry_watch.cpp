#include "drivers/contract/odometry_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kWindow = 1'000'000;      // [us]
constexpr std::int64_t kSessionSlack = 500'000;  // [us] ODOMETRY is slower than ROBOT_STATUS
constexpr double kDistanceSlack = 0.04;          // [m] over a window: twists are rounded and late
constexpr double kTurnSlack = 0.08;              // [rad]
constexpr double kShare = 0.2;                   // of the motion

double seconds_from(const odometry_t& from, const odometry_t& to) {
  return 1e-6 * static_cast<double>(to.utime - from.utime);
}

}  // namespace

void OdometryWatch::hear(const odometry_t& message) {
  if (message.theta <= -kPi || message.theta > kPi) {
    pose_.breach(fmt::format("theta = {:.3f}", message.theta));
  }
  if (last_ && (message.session != last_->session || message.utime <= last_->utime)) {
    window_.clear();
  }
  last_ = message;
  window_.push_back(message);
  while (window_.back().utime - window_.front().utime > kWindow) {
    judge_pose();
    window_.pop_front();
  }
}

void OdometryWatch::judge_pose() {
  double told_distance = 0.0;
  double told_turn = 0.0;
  double distance = 0.0;
  double turn = 0.0;
  for (std::size_t i = 1; i < window_.size(); ++i) {
    const odometry_t& a = window_[i - 1];
    const odometry_t& b = window_[i];
    const double passed = seconds_from(a, b);
    told_distance += 0.5 * passed * (a.linear + b.linear);
    told_turn += 0.5 * passed * (a.angular + b.angular);
    const double step = wrap_angle(b.theta - a.theta);
    const double heading = a.theta + 0.5 * step;
    distance += (b.x - a.x) * std::cos(heading) + (b.y - a.y) * std::sin(heading);
    turn += step;
  }
  const bool agrees = std::abs(distance - told_distance) <= kDistanceSlack + kShare * std::abs(told_distance) &&
                      std::abs(turn - told_turn) <= kTurnSlack + kShare * std::abs(told_turn);
  pose_.judge(agrees, fmt::format("{:.2f} m and {:.2f} rad in a second, by the twist {:.2f} m and {:.2f} rad", distance,
                                  turn, told_distance, told_turn));
}

void OdometryWatch::hear(const robot_status_t& message) {
  if (!message.connected) {
    differs_since_ = 0;
    return;
  }
  const bool is_same = message.session != 0 && last_ && last_->session == message.session;
  differs_since_ = is_same ? 0 : differs_since_ != 0 ? differs_since_ : message.utime;
  session_.judge(differs_since_ == 0 || message.utime - differs_since_ <= kSessionSlack,
                 fmt::format("{} in ROBOT_STATUS, {} in ODOMETRY", message.session, last_ ? last_->session : 0));
  if (last_ && is_same) {
    const double behind = 1e-6 * static_cast<double>(message.utime - last_->utime);
    constexpr double kBehind = 0.5;  // [s] five readings
    constexpr double kAhead = 0.05;  // [s] both on their way
    clock_.judge(behind > -kAhead && behind < kBehind, fmt::format("{:.2f} s behind", behind));
  }
}

}  // namespace luminav
