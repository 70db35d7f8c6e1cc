#include "drivers/p3dx/safety/wheel_watch.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kLongestPause = 0.3;  // [s] between two packets; what happened in a longer one is not known
constexpr double kHeldFor = 1.0;       // [s] after both wheels were told to turn and neither did

}  // namespace

void WheelWatch::restart() {
  forget_motion();
  fault_.clear();
}

void WheelWatch::forget_motion() {
  wheels_ = {};
  held_ = 0.0;
  utime_ = 0;
}

void WheelWatch::update(const InformationPacket& packet, const DriveVelocity& commanded, std::int64_t utime) {
  const double passed = utime_ == 0 ? 0.0 : std::min(kLongestPause, 1e-6 * static_cast<double>(utime - utime_));
  utime_ = utime;
  if (!packet.motors_enabled || packet.stop_button || packet.stall_left || packet.stall_right) {
    wheels_ = {};
    return;
  }
  const double turning = 0.5 * params_.wheel_base * commanded.angular;
  look(wheels_[0], commanded.linear - turning, 1e-3 * packet.left_mm_s, passed);
  look(wheels_[1], commanded.linear + turning, 1e-3 * packet.right_mm_s, passed);
  look_for_hands(passed);
  judge(wheels_[0], wheels_[1], "left", passed);
  judge(wheels_[1], wheels_[0], "right", passed);
}

void WheelWatch::look(Wheel& wheel, double asked, double counted, double passed) const {
  wheel.is_told = std::abs(asked) > params_.rest;
  wheel.must_turn = std::abs(asked) > params_.asked;
  wheel.turns_so = std::copysign(1.0, asked) * counted > params_.counted;
  const bool runs = std::abs(asked) < params_.rest && std::abs(counted) > params_.running;
  wheel.running = runs ? wheel.running + passed : 0.0;
}

/// A robot that is held or carried counts nothing on either side: its odometry is right, and it may go on afterwards.
void WheelWatch::look_for_hands(double passed) {
  if (wheels_[0].turns_so || wheels_[1].turns_so) {
    held_ = 0.0;
  } else if (wheels_[0].is_told && wheels_[1].is_told) {
    held_ = kHeldFor;
  } else {
    held_ = std::max(0.0, held_ - passed);
  }
}

/// While the other wheel is not told to turn nobody knows whether the robot is held: such time counts half.
void WheelWatch::judge(Wheel& wheel, const Wheel& other, const char* name, double passed) {
  if (wheel.turns_so) {
    wheel.dead = 0.0;
  } else if (wheel.must_turn && !other.must_turn) {
    wheel.dead += held_ > 0.0 ? 0.0 : 0.5 * passed;
  } else if (wheel.must_turn && other.turns_so) {
    wheel.dead += passed;
  }
  if (fault_.empty() && wheel.dead > params_.dead_after) {
    fault_ = std::string("the ") + name + " wheel is told to turn and its encoder does not count it";
  } else if (fault_.empty() && wheel.running > params_.runs_after) {
    fault_ = std::string("the ") + name + " wheel turns although it is told to stand";
  }
}

}  // namespace luminav
