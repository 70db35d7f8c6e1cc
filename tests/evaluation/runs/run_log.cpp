#include "tests/evaluation/runs/run_log.hpp"

#include <fmt/format.h>

#include <array>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxLines = 150;
// by navigation_status_t::STATE_*
constexpr std::array<const char*, 12> kNavigationStates{"IDLE",    "LOCALIZING", "PLANNING", "FOLLOWING",
                                                        "WAITING", "ARRIVED",    "NO_PATH",  "BLOCKED",
                                                        "STUCK",   "CANCELLED",  "LOST",     "PAUSED"};

const char* name_of_pose_state(int state) {
  switch (state) {
    case pose_t::STATE_TRACKING:
      return "TRACKING";
    case pose_t::STATE_AMBIGUOUS:
      return "AMBIGUOUS";
    default:
      return "LOST";
  }
}

}  // namespace

RunLog::RunLog(lcm::LCM& lcm) : subscriber_(lcm) {
  subscriber_.on(channels::kSimTruth, &RunLog::on_truth, this);
  subscriber_.on(channels::kPose, &RunLog::on_pose, this);
  subscriber_.on(channels::kNavigationStatus, &RunLog::on_navigation, this);
  subscriber_.on(channels::kControlStatus, &RunLog::on_control, this);
}

void RunLog::add(const std::string& who, const std::string& what) {
  if (lines_.size() >= kMaxLines) {
    lines_.erase(lines_.begin());
  }
  lines_.push_back(fmt::format("{:7.1f} s  {:<10} {}", elapsed_, who, what));
}

void RunLog::on_truth(const sim_truth_t& truth) {
  if (first_utime_ == 0) {
    first_utime_ = truth.utime;
  }
  elapsed_ = static_cast<double>(truth.utime - first_utime_) * 1e-6;
  if (truth.contacts + truth.hard_contacts > contacts_) {
    add("truth", fmt::format("contact at ({:.2f}, {:.2f})", truth.x, truth.y));
  }
  contacts_ = truth.contacts + truth.hard_contacts;
  if (truth.carries > carries_) {
    add("truth", fmt::format("carried away from ({:.2f}, {:.2f})", truth.x, truth.y));
  }
  carries_ = truth.carries;
}

void RunLog::on_pose(const pose_t& pose) {
  if (pose.state != pose_state_) {
    pose_state_ = pose.state;
    add("localizer", fmt::format("{}: {}", name_of_pose_state(pose.state), pose.reason));
  }
}

void RunLog::on_navigation(const navigation_status_t& status) {
  if (status.state != navigation_state_) {
    navigation_state_ = status.state;
    const auto index = static_cast<std::size_t>(status.state);
    const std::string name = index < kNavigationStates.size() ? kNavigationStates[index] : "unknown state";
    add("planner", status.cause.empty() ? name : name + ": " + status.cause);
  }
}

void RunLog::on_control(const control_status_t& status) {
  if (status.state != control_state_) {
    control_state_ = status.state;
    if (!status.reason.empty()) {
      add("controller", status.reason);
    }
  }
}

}  // namespace luminav
