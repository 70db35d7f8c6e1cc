#include "drivers/contract/request_watch.hpp"

#include <fmt/format.h>

namespace luminav {
namespace {

constexpr double kEcho = 0.5;     // [s] requests are repeated at 5 Hz
constexpr double kMotors = 3.0;   // [s] some bases wait for a relay
constexpr double kRelease = 2.0;  // [s] after a release nothing comes on by itself

}  // namespace

double RequestWatch::age(const Request& request) const {
  return 1e-6 * static_cast<double>(now_ - request.utime);
}

void RequestWatch::hear(const stop_t& message) {
  if (now_ != 0 && (!stop_ || message.id > stop_->id)) {
    stop_ = Request{message.id, message.engaged != 0, now_};
  }
}

void RequestWatch::hear(const motors_command_t& message) {
  if (now_ != 0 && (!motors_ || message.id > motors_->id)) {
    motors_ = Request{message.id, message.enable != 0, now_};
  }
}

void RequestWatch::hear(const robot_status_t& message) {
  now_ = message.utime;
  if (last_ && last_->stop_engaged && !message.stop_engaged) {
    stop_latch_.require(stop_ && !stop_->wish, "it ended without a release");
  } else if (message.stop_engaged) {
    stop_latch_.keep();
  }
  if (stop_ && age(*stop_) > kEcho) {
    stop_echo_.judge(message.stop_id >= stop_->id && (message.stop_engaged != 0) == stop_->wish,
                     fmt::format("stop_id {} for {}, stop_engaged {}", message.stop_id, stop_->id,
                                 static_cast<int>(message.stop_engaged)));
  }
  if (motors_ && age(*motors_) > kEcho) {
    motors_echo_.judge(message.motors_command_id >= motors_->id,
                       fmt::format("{} for {}", message.motors_command_id, motors_->id));
  }
  if (motors_ && (message.motors_enabled != 0) == motors_->wish) {
    motors_->is_obeyed = true;
  }
  if (motors_ && age(*motors_) > kMotors && !message.stop_button && message.connected) {
    motors_state_.require(motors_->is_obeyed,
                          motors_->wish ? "asked for on, they are off" : "asked for off, they are on");
  }
  const bool was_released = stop_ && !stop_->wish && age(*stop_) < kRelease;
  const bool is_asked_for = motors_ && motors_->wish;
  if (was_released && last_ && !is_asked_for && !last_->motors_enabled) {
    motors_rest_.require(!message.motors_enabled, "they came on when the STOP was released");
  }
  last_ = message;
}

}  // namespace luminav
