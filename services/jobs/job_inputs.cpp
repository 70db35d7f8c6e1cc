#include "services/jobs/job_inputs.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/process/lcm_conversions.hpp"
#include "services/jobs/job_messages.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kPoseAge = 1'000'000;  // [us] an older pose does not count
constexpr std::size_t kMaxEchoes = 100;       // without a tick

}  // namespace

void JobInputs::take(const sonar_t& message) {
  const std::optional<Pose2> robot = pose_at(message.utime);
  if (!robot || echoes_.size() > kMaxEchoes) {
    return;
  }
  const std::size_t discs = std::min(ring_.robot_from_sonar.size(), message.range.size());
  for (std::size_t disc = 0; disc < discs; ++disc) {
    if (message.fresh.at(disc) != 0 && message.has_echo.at(disc) != 0) {
      echoes_.push_back(
          {*robot * ring_.robot_from_sonar[disc], ring_.half_angle, static_cast<double>(message.range[disc])});
    }
  }
}

std::optional<Pose2> JobInputs::pose_at(std::int64_t utime) const {
  const bool is_known = pose_ && pose_->state == pose_t::STATE_TRACKING && std::abs(utime - pose_->utime) < kPoseAge;
  return is_known ? std::optional(world_from_robot(*pose_)) : std::nullopt;
}

JobMoment JobInputs::moment(const robot_status_t& status, double seconds) {
  JobMoment moment;
  moment.utime = status.utime;
  moment.seconds = seconds;
  if (navigation_) {
    moment.navigation = navigation_from(*navigation_);
    navigation_.reset();
  }
  moment.world_from_robot = pose_at(status.utime);
  moment.handled = who_handles(status);
  moment.voltage = status.battery_voltage;
  moment.charger = status.charge_state > robot_status_t::CHARGE_BULK   ? Charger::kHasCharged
                   : status.charge_state > robot_status_t::CHARGE_NONE ? Charger::kCharges
                                                                       : Charger::kNotHeard;
  moment.driven = std::max(0.0, status.linear) * seconds;
  moment.echoes = std::exchange(echoes_, {});
  return moment;
}

}  // namespace luminav
