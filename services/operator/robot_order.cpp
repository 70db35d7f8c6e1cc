#include "services/operator/robot_order.hpp"

#include <cmath>
#include <luminav/motors_command_t.hpp>
#include <luminav/stop_t.hpp>
#include <stdexcept>

#include "services/common/process/channels.hpp"

namespace luminav {

RobotOrder::RobotOrder(lcm::LCM& lcm, RobotWish wish, std::int64_t id, const std::string& sender,
                       std::optional<CommandKey> key)
    : commands_(lcm, key), subscriber_(lcm), wish_(wish), id_(id), sender_(sender) {
  subscriber_.on(channels::kRobotStatus, &RobotOrder::on_robot_status, this);
  subscriber_.on(channels::kControlStatus, &RobotOrder::on_control_status, this);
}

void RobotOrder::tick() {
  if (is_obeyed()) {
    return;
  }
  int sent = 0;
  if (is_about_stop()) {
    stop_t request{};
    request.utime = request.id = id_;
    request.engaged = wish_ == RobotWish::kStop ? 1 : 0;
    request.sender = sender_;
    sent = commands_.publish(channels::kStop, request);
  } else {
    motors_command_t request{};
    request.utime = request.id = id_;
    request.enable = wish_ == RobotWish::kMotorsOn ? 1 : 0;
    sent = commands_.publish(channels::kMotorsCommand, request);
  }
  if (sent < 0) {
    throw std::runtime_error("the network takes nothing: use the button on the robot");
  }
}

void RobotOrder::on_robot_status(const robot_status_t& message) {
  robot_ = message;
  const bool has_obeyed =
      is_about_stop() ? obeys(message.stop_id, message.stop_engaged != 0) : message.motors_command_id == id_;
  driver_obeyed_ = driver_obeyed_ || has_obeyed;
}

void RobotOrder::on_control_status(const control_status_t& message) {
  control_ = message;
  controller_obeyed_ = controller_obeyed_ || obeys(message.stop_id, message.stop_engaged != 0);
}

bool RobotOrder::obeys(std::int64_t stop_id, bool engaged) const {
  return stop_id == id_ && engaged == (wish_ == RobotWish::kStop);
}

bool RobotOrder::is_obeyed() const {
  return driver_obeyed_ && (controller_obeyed_ || !is_about_stop());
}

bool RobotOrder::stands() const {
  constexpr double kStill = 0.02;  // [m/s, rad/s]
  return robot_ && std::abs(robot_->linear) < kStill && std::abs(robot_->angular) < kStill;
}

std::string RobotOrder::progress() const {
  const auto missing = [](bool is_heard, const char* who) {
    return std::string(who) + (is_heard ? " has not obeyed yet" : " is not heard");
  };
  if (!driver_obeyed_) {
    return missing(robot_.has_value(), "the driver");
  }
  return is_obeyed() ? "obeyed" : missing(control_.has_value(), "the controller");
}

}  // namespace luminav
