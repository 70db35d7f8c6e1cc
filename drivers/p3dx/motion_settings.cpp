#include "drivers/p3dx/motion_settings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;  // [us]
constexpr int kMax = 20;                     // then the robot does not want to

int in_mm(double metres) {
  return static_cast<int>(std::lround(1000.0 * metres));
}
int in_degrees(double angle) {
  return static_cast<int>(std::lround(degrees(angle)));
}

}  // namespace

void MotionSettings::begin(double maximum_linear, double maximum_angular) {
  limits_.linear = maximum_linear;
  limits_.angular = maximum_angular;
  sent_ = 0;
}

std::vector<std::vector<std::uint8_t>> MotionSettings::poll(std::int64_t now, const ConfigurationPacket* robot) {
  const bool some_were_lost = robot != nullptr && !in_force(*robot) && sent_ < kMax && now - sent_at_ > kPeriod;
  if (sent_ > 0 && !some_were_lost) {
    return {};
  }
  ++sent_;
  sent_at_ = now;
  return frames();
}

bool MotionSettings::in_force(const ConfigurationPacket& robot) const {
  return robot.velocity_maximum == in_mm(limits_.linear) &&
         robot.acceleration == std::min(in_mm(limits_.linear_acceleration), robot.acceleration_top) &&
         robot.deceleration == std::min(in_mm(limits_.linear_deceleration), robot.acceleration_top);
}

std::vector<std::vector<std::uint8_t>> MotionSettings::frames() const {
  std::vector<std::vector<std::uint8_t>> frames;
  for (const auto& [command, value] : {
           std::pair{ArcosCommand::kSetMaximumVelocity, in_mm(limits_.linear)},
           std::pair{ArcosCommand::kSetAcceleration, in_mm(limits_.linear_acceleration)},
           std::pair{ArcosCommand::kSetAcceleration, -in_mm(limits_.linear_deceleration)},
           // One degree/s is the step of turn rates: rounded up, so that the limit itself can be reached.
           std::pair{ArcosCommand::kSetMaximumTurnRate, static_cast<int>(std::ceil(degrees(limits_.angular)))},
           std::pair{ArcosCommand::kSetTurnAcceleration, in_degrees(limits_.angular_acceleration)},
           std::pair{ArcosCommand::kSetTurnAcceleration, -in_degrees(angular_deceleration_)},
       }) {
    frames.push_back(encode_command(command, value));
  }
  frames.push_back(encode_command(ArcosCommand::kConfiguration));  // reads them back
  return frames;
}

}  // namespace luminav
