#include "drivers/create2/hazard_watch.hpp"

namespace luminav {

bool HazardWatch::update(const SensorReading& reading) {
  const int before = bumpers_;
  const bool was_lifted = lifted_;
  bumpers_ = (reading.bump_left ? kBumpLeft : 0) | (reading.bump_right ? kBumpRight : 0) |
             (reading.cliff_left ? kCliffLeft : 0) | (reading.cliff_front_left ? kCliffFrontLeft : 0) |
             (reading.cliff_front_right ? kCliffFrontRight : 0) | (reading.cliff_right ? kCliffRight : 0);
  lifted_ = reading.wheel_drop_left || reading.wheel_drop_right;
  return (bumpers_ & ~before) != 0 || (lifted_ && !was_lifted);
}

bool HazardWatch::forbids(const DriveVelocity& wanted) const {
  return (lifted_ && wanted != DriveVelocity{}) || (bumpers_ != 0 && wanted.linear > 0.0) ||
         (sees_cliff() && leads_over_an_edge(wanted.linear, wanted.angular));
}

std::string HazardWatch::reason() const {
  if (lifted_) {
    return "a wheel hangs in the air";
  }
  if (sees_cliff()) {
    const bool left = (bumpers_ & (kCliffLeft | kCliffFrontLeft)) != 0;
    const bool right = (bumpers_ & (kCliffRight | kCliffFrontRight)) != 0;
    return left && right ? "the floor ends ahead" : left ? "the floor ends on the left" : "the floor ends on the right";
  }
  if (bumpers_ == 0) {
    return {};
  }
  return bumpers_ == (kBumpLeft | kBumpRight) ? "it touches something ahead"
         : bumpers_ == kBumpLeft              ? "it touches something on the left"
                                              : "it touches something on the right";
}

}  // namespace luminav
