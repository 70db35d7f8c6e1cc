#include "drivers/create2/wheel_odometry.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kSlack = 0.02;         // [m]
constexpr double kMinInterval = 0.015;  // [s]
constexpr int kConfirmations = 3;

int shortest(std::uint16_t from, std::uint16_t to) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

double seconds(std::int64_t microseconds) {
  return 1e-6 * static_cast<double>(microseconds);
}

}  // namespace

bool WheelOdometry::is_possible(const Counts& from, const Counts& to) const {
  const double allowed = kSlack + params_.maximum_speed * std::max(kMinInterval, seconds(to.utime - from.utime));
  const int step = std::max(std::abs(shortest(from.left, to.left)), std::abs(shortest(from.right, to.right)));
  return params_.distance_per_count * step <= allowed;
}

WheelOdometry::Verdict WheelOdometry::update(const SensorReading& reading, std::int64_t utime) {
  const Counts now{reading.left_count, reading.right_count, utime};
  if (!last_) {
    last_ = now;
    return Verdict::kAccepted;
  }
  if (!is_possible(*last_, now)) {
    candidate_count_ = candidate_ && is_possible(*candidate_, now) ? candidate_count_ + 1 : 1;
    candidate_ = now;
    if (candidate_count_ < kConfirmations) {
      return Verdict::kRefused;
    }
    last_ = now;
    candidate_.reset();
    return Verdict::kJumped;
  }
  const double left = params_.distance_per_count * shortest(last_->left, now.left);
  const double right = params_.distance_per_count * shortest(last_->right, now.right);
  const double distance = 0.5 * (left + right);
  const double turn = (right - left) / params_.wheel_base;
  const double heading = odom_from_robot_.theta + 0.5 * turn;
  odom_from_robot_ = {odom_from_robot_.x + distance * std::cos(heading),
                      odom_from_robot_.y + distance * std::sin(heading), wrap_angle(odom_from_robot_.theta + turn)};
  distance_ += distance;
  turn_ += turn;
  last_ = now;
  candidate_.reset();
  return Verdict::kAccepted;
}

void WheelOdometry::measure_twist(std::int64_t utime) {
  const double passed = seconds(utime - measured_at_);
  const bool is_first = measured_at_ == 0 || passed <= 0.0;
  linear_ = is_first ? 0.0 : distance_ / passed;
  angular_ = is_first ? 0.0 : turn_ / passed;
  distance_ = turn_ = 0.0;
  measured_at_ = utime;
}

}  // namespace luminav
