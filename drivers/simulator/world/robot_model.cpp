#include "drivers/simulator/world/robot_model.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kMotorLag = 0.04;        // [s] of the speed loop; the ramps are the microcontroller's
constexpr double kTraction = 4.0;         // [m/s^2] more slips; also what an emergency stop gives
constexpr double kRollingFriction = 1.5;  // [m/s^2] without power
constexpr double kStanding = 0.002;       // [m/s] slower wheels without a command stand
constexpr double kNoiseDistance = 0.05;   // [m] over which one draw of the noise holds
constexpr double kSpinning = 0.3;         // probability that blocked wheels spin instead of stalling

double follow(double speed, double wanted, double dt, bool powered) {
  const double limit = (powered ? kTraction : kRollingFriction) * dt;
  const double change = powered ? (wanted - speed) * -std::expm1(-dt / kMotorLag) : -speed;
  const double next = speed + std::clamp(change, -limit, limit);
  return wanted == 0.0 && std::abs(next) < kStanding ? 0.0 : next;
}

}  // namespace

RobotModel::RobotModel(const WorldTruth& truth, std::uint64_t seed)
    : believed_base_(truth.wheels.believed_base),
      true_base_(truth.robot.wheel_base),
      scale_left_(truth.wheels.scale_left),
      scale_right_(truth.wheels.scale_right),
      noise_position_(truth.wheels.noise_position),
      noise_heading_(truth.wheels.noise_heading),
      random_(seed, "odometry"),
      hold_random_(seed, "contact") {}

WheelStep RobotModel::step(double dt, const MotorCommand& command) {
  const double linear = command.enabled ? command.linear : 0.0;
  const double turning = command.enabled ? 0.5 * believed_base_ * command.angular : 0.0;
  left_speed_ = follow(left_speed_, linear - turning, dt, command.enabled);
  right_speed_ = follow(right_speed_, linear + turning, dt, command.enabled);
  WheelStep result;
  result.left = left_speed_ * dt;
  result.right = right_speed_ * dt;
  const double distance = 0.5 * (std::abs(result.left) + std::abs(result.right));
  if (distance == 0.0) {
    return result;
  }
  noise_distance_ -= distance;
  if (noise_distance_ <= 0.0) {
    draw_noise();
  }
  const double ground_left = grip_ * scale_left_ * result.left;
  const double ground_right = grip_ * scale_right_ * result.right;
  const double forward = 0.5 * (ground_left + ground_right) + stretch_ * distance;
  const double turn = (ground_right - ground_left) / true_base_ + twist_ * distance;
  result.robot_from_next = {forward * std::cos(0.5 * turn), forward * std::sin(0.5 * turn), turn};
  return result;
}

bool RobotModel::hold(bool begins) {
  if (begins) {
    spins_when_held_ = hold_random_.happens(kSpinning);
  }
  if (!spins_when_held_) {
    stall();
  }
  return spins_when_held_;
}

void RobotModel::draw_noise() {
  noise_distance_ += kNoiseDistance;
  stretch_ = random_.gaussian(noise_position_ / std::sqrt(kNoiseDistance));
  twist_ = random_.gaussian(noise_heading_ / std::sqrt(kNoiseDistance));
}

}  // namespace luminav
