#include "drivers/p3dx/dead_reckoning.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr int kDistanceModulus = 32768;  // right for robots that wrap at 15 bits and at 16
constexpr int kHeadingModulus = 4096;
constexpr double kHeadingUnit = 2.0 * kPi / kHeadingModulus;  // [rad]
constexpr int kConfirmations = 3;
constexpr double kDistanceSlack = 0.05;  // [m]
constexpr double kHeadingSlack = radians(10.0);
constexpr double kMinInterval = 0.15;  // [s] packets that were held back arrive together, each with a whole cycle

int shortest(int difference, int modulus) {
  const int wrapped = ((difference % modulus) + modulus) % modulus;
  return wrapped >= modulus / 2 ? wrapped - modulus : wrapped;
}

}  // namespace

bool DeadReckoning::is_possible(const Registers& from, const Registers& to) const {
  const double interval = std::max(kMinInterval, static_cast<double>(to.utime - from.utime) * 1e-6);
  const double unit = params_.distance_factor * 1e-3;
  const double step =
      unit * std::hypot(shortest(to.x - from.x, kDistanceModulus), shortest(to.y - from.y, kDistanceModulus));
  const double turn = kHeadingUnit * std::abs(shortest(to.heading - from.heading, kHeadingModulus));
  return step <= kDistanceSlack + interval * params_.maximum_speed &&
         turn <= kHeadingSlack + interval * params_.maximum_turn_rate;
}

void DeadReckoning::take_reference(const Registers& registers) {
  last_ = registers;
  candidate_.reset();
  x_ = registers.x;
  y_ = registers.y;
  heading_ = registers.heading;
}

DeadReckoning::Verdict DeadReckoning::update(const InformationPacket& packet, std::int64_t utime) {
  const Registers now{packet.x_mm, packet.y_mm, packet.heading, utime};
  const double wheel_limit = 2000.0 * params_.maximum_speed;  // [mm/s] turning on the spot is faster than driving
  Verdict verdict = Verdict::kAccepted;
  if (std::max(std::abs(packet.left_mm_s), std::abs(packet.right_mm_s)) > wheel_limit) {
    return Verdict::kRefused;
  }
  if (!last_) {
    take_reference(now);
  } else if (is_possible(*last_, now)) {
    x_ += shortest(now.x - last_->x, kDistanceModulus);
    y_ += shortest(now.y - last_->y, kDistanceModulus);
    heading_ += shortest(now.heading - last_->heading, kHeadingModulus);
    last_ = now;
    candidate_.reset();
  } else {
    candidate_count_ = candidate_ && is_possible(*candidate_, now) ? candidate_count_ + 1 : 1;
    candidate_ = now;
    if (candidate_count_ < kConfirmations) {
      return Verdict::kRefused;
    }
    take_reference(now);
    verdict = Verdict::kJumped;
  }
  linear_ = 0.5e-3 * (packet.left_mm_s + packet.right_mm_s);
  angular_ = packet.turn_rate ? radians(0.1 * *packet.turn_rate)
                              : 0.5 * (packet.right_mm_s - packet.left_mm_s) * params_.wheel_factor;
  return verdict;
}

Pose2 DeadReckoning::odom_from_robot() const {
  const double unit = params_.distance_factor * 1e-3;
  return {unit * static_cast<double>(x_), unit * static_cast<double>(y_),
          wrap_angle(kHeadingUnit *
                     static_cast<double>(shortest(static_cast<int>(heading_ % kHeadingModulus), kHeadingModulus)))};
}

}  // namespace luminav
