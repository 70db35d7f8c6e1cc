#include "drivers/create2/wheel_writer.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/create2/oi/oi_commands.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kCycle = 18'000;    // [us] 50 Hz, called a little early at times
constexpr std::int64_t kRepeat = 100'000;  // [us] nothing is acknowledged, so all is said again
constexpr double kFirstStep = 0.02;        // [s] of a ramp that begins
constexpr double kLongestStep = 0.05;      // [s] of a ramp

double approach(double value, double target, double rise, double fall) {
  const bool slows = std::abs(target) < std::abs(value) || value * target < 0.0;
  const double end = value * target < 0.0 ? 0.0 : target;
  const double step = slows ? fall : rise;
  return value + std::clamp(end - value, -step, step);
}

}  // namespace

void WheelWriter::restart() {
  velocity_ = {};
  left_mm_s_ = right_mm_s_ = 0;
  sent_at_ = 0;
}

std::vector<std::uint8_t> WheelWriter::halt(std::int64_t now) {
  restart();
  sent_at_ = ramped_at_ = now;
  return encode_drive_direct(0, 0);
}

std::optional<std::vector<std::uint8_t>> WheelWriter::poll(const DriveVelocity& wanted, std::int64_t now) {
  if (sent_at_ != 0 && now - ramped_at_ < kCycle) {
    return std::nullopt;
  }
  const double passed = 1e-6 * static_cast<double>(now - ramped_at_);
  const double step = sent_at_ == 0 ? kFirstStep : std::clamp(passed, 0.0, kLongestStep);
  ramped_at_ = now;
  velocity_.linear =
      approach(velocity_.linear, wanted.linear, step * limits_.linear_acceleration, step * limits_.linear_deceleration);
  velocity_.angular = approach(velocity_.angular, wanted.angular, step * limits_.angular_acceleration,
                               step * limits_.angular_acceleration);
  const double turning = 0.5 * wheel_base_ * velocity_.angular;
  const double fastest = 1000.0 * (std::abs(velocity_.linear) + std::abs(turning));
  const double share = fastest > kOiMaxWheelSpeed ? kOiMaxWheelSpeed / fastest : 1.0;  // on the same arc
  const int left = static_cast<int>(std::lround(1000.0 * share * (velocity_.linear - turning)));
  const int right = static_cast<int>(std::lround(1000.0 * share * (velocity_.linear + turning)));
  if (sent_at_ != 0 && left == left_mm_s_ && right == right_mm_s_ && now - sent_at_ < kRepeat) {
    return std::nullopt;
  }
  left_mm_s_ = left;
  right_mm_s_ = right;
  sent_at_ = now;
  return encode_drive_direct(left, right);
}

}  // namespace luminav
