#include "tests/system/faults/robot_watch.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr const char* kNavigationWords[] = {"IDLE",    "LOCALIZING", "PLANNING", "FOLLOWING", "WAITING", "ARRIVED",
                                            "NO_PATH", "BLOCKED",    "STUCK",    "CANCELLED", "LOST",    "PAUSED"};
constexpr const char* kControlWords[] = {"IDLE",     "WANDERING", "FOLLOWING", "TURNING", "AT_GOAL",
                                         "YIELDING", "ESCAPING",  "STUCK",     "STOPPED", "TELEOP"};

template <std::size_t kCount>
const char* word(const char* const (&words)[kCount], int state) {
  return state >= 0 && state < static_cast<int>(kCount) ? words[state] : "?";
}

void remember(std::deque<std::int64_t>& arrivals, std::int64_t now) {
  constexpr std::int64_t kMemory = 60'000'000;
  arrivals.push_back(now);
  while (arrivals.front() < now - kMemory) {
    arrivals.pop_front();
  }
}

std::optional<std::int64_t> first_after(const std::deque<std::int64_t>& arrivals, std::int64_t utime) {
  const auto found = std::upper_bound(arrivals.begin(), arrivals.end(), utime);
  return found != arrivals.end() ? std::optional(*found) : std::nullopt;
}

}  // namespace

RobotWatch::RobotWatch(lcm::LCM& lcm, const Clock& clock) : clock_(clock), subscriber_(lcm) {
  subscriber_.on(channels::kNavigationStatus, &RobotWatch::on_navigation, this);
  subscriber_.on(channels::kControlStatus, &RobotWatch::on_control, this);
  subscriber_.on(channels::kPose, &RobotWatch::on_pose, this);
  subscriber_.on(channels::kRobotStatus, &RobotWatch::on_robot, this);
  subscriber_.on(channels::kVelocityCommand, &RobotWatch::on_command, this);
}

void RobotWatch::on_pose(const pose_t& pose) {
  pose_ = pose;
  if (is_tracking()) {
    remember(tracking_poses_, clock_.utime());
  }
}

void RobotWatch::on_robot(const robot_status_t& status) {
  robot_ = status;
  if (status.connected && status.motors_enabled) {
    remember(connected_, clock_.utime());
  }
}

void RobotWatch::on_command(const velocity_command_t&) {
  remember(commands_, clock_.utime());
}

std::optional<std::int64_t> RobotWatch::commanded_after(std::int64_t utime) const {
  return first_after(commands_, utime);
}

std::optional<std::int64_t> RobotWatch::tracked_after(std::int64_t utime) const {
  return first_after(tracking_poses_, utime);
}

std::optional<std::int64_t> RobotWatch::connected_after(std::int64_t utime) const {
  return first_after(connected_, utime);
}

bool RobotWatch::is_following() const {
  return navigation_ && navigation_->state == navigation_status_t::STATE_FOLLOWING;
}

bool RobotWatch::is_tracking() const {
  return pose_ && pose_->state == pose_t::STATE_TRACKING;
}

std::string RobotWatch::sentence() const {
  std::string text;
  const auto age = [this](std::int64_t utime) { return static_cast<double>(clock_.utime() - utime) * 1e-6; };
  if (pose_) {
    text +=
        fmt::format("pose {} ({:.2f}, {:.2f}) {:.1f} s old{}", word({"LOST", "AMBIGUOUS", "TRACKING"}, pose_->state),
                    pose_->x, pose_->y, age(pose_->utime), pose_->reason.empty() ? "" : ": " + pose_->reason);
  }
  if (navigation_) {
    text += fmt::format("; planner {} goal {} {:.1f} m left {:.1f} s old{}", word(kNavigationWords, navigation_->state),
                        navigation_->goal_id % 1'000'000, navigation_->distance_left, age(navigation_->utime),
                        navigation_->cause.empty() ? "" : ": " + navigation_->cause);
  }
  if (control_) {
    text += fmt::format("; controller {} goal {} {:.1f} s old{}", word(kControlWords, control_->state),
                        control_->goal_id % 1'000'000, age(control_->utime),
                        control_->reason.empty() ? "" : ": " + control_->reason);
  }
  if (robot_ && !robot_->reason.empty()) {
    text += "; driver: " + robot_->reason;
  }
  return text;
}

}  // namespace luminav
