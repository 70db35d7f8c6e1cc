#include "drivers/contract/check_base_node.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "services/common/process/channels.hpp"

namespace luminav {

CheckBaseNode::CheckBaseNode(lcm::LCM& lcm, const RobotDescription& robot, const Clock& clock,
                             const CheckBaseOptions& options)
    : clock_(clock), robot_(robot.name), contract_(robot, options.process), subscriber_(lcm) {
  if (options.drives) {
    exercise_.emplace(lcm, robot.name, options.key);
  }
  subscriber_.on(channels::kOdometry, &CheckBaseNode::on_odometry, this);
  subscriber_.on(channels::kSonar, &CheckBaseNode::on_sonar, this);
  subscriber_.on(channels::kRobotStatus, &CheckBaseNode::on_robot_status, this);
  subscriber_.on(channels::kNodeStatus, &CheckBaseNode::on_node_status, this);
  subscriber_.on(channels::kVelocityCommand, &CheckBaseNode::on_velocity_command, this);
  subscriber_.on(channels::kStop, &CheckBaseNode::on_stop, this);
  subscriber_.on(channels::kMotorsCommand, &CheckBaseNode::on_motors_command, this);
}

void CheckBaseNode::on_robot_status(const robot_status_t& message) {
  contract_.hear(message, clock_.utime());
  if (exercise_) {
    exercise_->hear(message);
  }
}

void CheckBaseNode::on_velocity_command(const velocity_command_t& message) {
  contract_.hear(message);
  if (exercise_) {
    exercise_->hear(message);
  }
}

std::string describe(const std::vector<Clause>& clauses) {
  static constexpr const char* kVerdicts[] = {"not seen", "holds", "BROKEN"};
  std::string text;
  for (const Clause& clause : clauses) {
    text +=
        fmt::format("{:<9} {:<79} {}", kVerdicts[static_cast<int>(clause.verdict())], clause.text(), clause.evidence());
    text += clause.breaches() > 1 ? fmt::format(" ({} times)\n", clause.breaches()) : "\n";
  }
  return text;
}

int exit_status(const std::vector<Clause>& clauses, bool must_see_all) {
  return std::all_of(clauses.begin(), clauses.end(),
                     [&](const Clause& clause) {
                       return clause.verdict() == Clause::Verdict::kHolds ||
                              (clause.verdict() == Clause::Verdict::kNotSeen && !must_see_all);
                     })
             ? 0
             : 1;
}

}  // namespace luminav
