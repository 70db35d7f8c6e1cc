#include "drivers/contract/base_contract.hpp"

#include <fmt/format.h>

namespace luminav {
namespace {

void append(std::vector<Clause>& clauses, const std::vector<Clause>& more) {
  clauses.insert(clauses.end(), more.begin(), more.end());
}

}  // namespace

BaseContract::BaseContract(const RobotDescription& robot, const std::string& process)
    : robot_(robot), process_(process), ring_(robot.sonar), motion_(robot) {}

void BaseContract::hear(const odometry_t& message, std::int64_t arrival) {
  odometry_stream_.hear({arrival, message.utime, message.session, message.sequence});
  odometry_.hear(message);
  motion_.hear(message);
}

void BaseContract::hear(const sonar_t& message, std::int64_t arrival) {
  sonar_stream_.hear({arrival, message.utime, message.session, message.sequence});
  ring_.hear(message);
}

void BaseContract::hear(const robot_status_t& message, std::int64_t arrival) {
  status_stream_.hear({arrival, message.utime, 0, message.sequence});  // counts over sessions
  odometry_.hear(message);
  motion_.hear(message);
  requests_.hear(message);
  judge_status(message);
}

void BaseContract::hear(const node_status_t& message, std::int64_t arrival) {
  if (message.robot == robot_.name && message.process == process_) {
    node_first_ = node_count_ == 0 ? arrival : node_first_;
    node_last_ = arrival;
    ++node_count_;
  }
}

void BaseContract::hear(const stop_t& message) {
  motion_.hear(message);
  requests_.hear(message);
}

void BaseContract::judge_status(const robot_status_t& message) {
  name_.judge(message.robot == robot_.name, fmt::format("\"{}\", the file says \"{}\"", message.robot, robot_.name));
  constexpr double kRounding = 0.01;
  const MotionLimits& limits = robot_.limits;
  limits_.judge(message.maximum_linear > 0.0 && message.maximum_linear <= limits.linear + kRounding &&
                    message.maximum_angular > 0.0 && message.maximum_angular <= limits.angular + kRounding &&
                    message.deceleration > 0.0,
                fmt::format("{:.2f} m/s, {:.2f} rad/s, {:.2f} m/s^2", message.maximum_linear, message.maximum_angular,
                            message.deceleration));
  if (!message.connected || !message.motors_enabled || message.stop_engaged || message.stop_button) {
    reason_.judge(!message.reason.empty(), message.reason.empty() ? "there is none" : message.reason);
  }
}

std::vector<Clause> BaseContract::clauses() const {
  Clause node("NODE_STATUS: the driver's own word, once a second");
  const double heard = 1e-6 * static_cast<double>(node_last_ - node_first_);
  constexpr double kJudgeable = 2.0;  // [s]
  if (node_count_ == 0) {
    node.breach(fmt::format("none of \"{}\" came", process_));
  } else if (heard >= kJudgeable) {
    constexpr double kSlack = 0.8;
    node.judge((node_count_ - 1) / heard >= kSlack, fmt::format("{:.1f} Hz", (node_count_ - 1) / heard));
  }
  std::vector<Clause> clauses = odometry_stream_.clauses();
  append(clauses, odometry_.clauses());
  if (!robot_.sonar.robot_from_sonar.empty()) {
    append(clauses, sonar_stream_.clauses());
    append(clauses, ring_.clauses());
  }
  append(clauses, status_stream_.clauses());
  append(clauses, {name_, limits_, reason_});
  append(clauses, motion_.clauses());
  append(clauses, requests_.clauses());
  clauses.push_back(node);
  return clauses;
}

}  // namespace luminav
