#include "services/viewer/helm.hpp"

#include <fmt/format.h>

#include <cmath>
#include <luminav/teleop_command_t.hpp>

#include "services/common/process/channels.hpp"
#include "services/viewer/request_desk.hpp"

namespace luminav {

void Helm::on_robot_status(const robot_status_t& message) {
  const std::lock_guard lock(mutex_);
  robot_utime_ = message.utime;
}

void Helm::steer(const Steering& steering, std::int64_t now) {
  const std::lock_guard lock(mutex_);
  if (std::abs(steering.linear) > limits_.linear || std::abs(steering.angular) > limits_.angular) {
    throw RequestError(fmt::format("steering: at most {} m/s and {:.2f} rad/s", limits_.linear, limits_.angular));
  }
  if (robot_utime_ == 0) {
    throw RequestError("no robot was heard yet");
  }
  if (now - steering.seen > kFresh || steering.seen - now > kFresh) {
    throw RequestError("steering: came too late");
  }
  if (steering.session == session_) {
    if (steering.sequence <= sequence_) {
      throw RequestError("steering: out of order");
    }
  } else if (now - steered_ < kHandOver && now >= steered_) {
    throw RequestError("another person steers");
  }
  session_ = steering.session;
  sequence_ = steering.sequence;
  steered_ = now;
  teleop_command_t command{};
  command.utime = robot_utime_;
  command.session = steering.session;
  command.sequence = steering.sequence;
  command.linear = steering.linear;
  command.angular = steering.angular;
  if (commands_.publish(channels::kTeleopCommand, command) < 0) {
    throw NotSent("the network took nothing: it was not sent");
  }
}

}  // namespace luminav
