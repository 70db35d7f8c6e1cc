#include "tests/evaluation/demo/demo_display.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr double kRefresh = 0.25;   // [s] in place
constexpr double kLineEvery = 5.0;  // [s] as lines

const char* localization_word(int state) {
  return state == pose_t::STATE_TRACKING ? "TRACKING" : state == pose_t::STATE_AMBIGUOUS ? "AMBIGUOUS" : "LOST";
}

const char* navigation_word(int state) {
  constexpr const char* kWords[] = {"IDLE",    "LOCALIZING", "PLANNING", "FOLLOWING", "WAITING", "ARRIVED",
                                    "NO_PATH", "BLOCKED",    "STUCK",    "CANCELLED", "LOST",    "PAUSED"};
  return state >= 0 && state < 12 ? kWords[state] : "?";
}

}  // namespace

DemoDisplay::DemoDisplay(lcm::LCM& lcm, const RunJudge& judge, const Mission& mission, const Scenario& scenario,
                         bool headless)
    : judge_(judge),
      mission_(mission),
      scenario_(scenario),
      in_place_(!headless && isatty(STDOUT_FILENO) != 0),
      subscriber_(lcm) {
  subscriber_.on(channels::kHypotheses, &DemoDisplay::on_hypotheses, this);
}

std::string DemoDisplay::belief() const {
  if (!judge_.pose()) {
    return "no pose yet";
  }
  const pose_t& pose = *judge_.pose();
  if (pose.state == pose_t::STATE_TRACKING) {
    return fmt::format("TRACKING ({:6.2f}, {:6.2f}, {:4.0f} deg), truly off by {:.3f} m, {:.1f} deg", pose.x, pose.y,
                       degrees(pose.theta), judge_.position_error(), degrees(judge_.heading_error()));
  }
  return fmt::format("{} with {} {}: {}", localization_word(pose.state), hypotheses_,
                     hypotheses_ == 1 ? "hypothesis" : "hypotheses", pose.reason);
}

std::string DemoDisplay::goal() const {
  if (mission_.current_goal() >= scenario_.goals.size()) {
    return "all goals done";
  }
  const ScenarioGoal& goal = scenario_.goals[mission_.current_goal()];
  const std::string name = goal.place.empty() ? fmt::format("({:.2f}, {:.2f})", goal.pose.x, goal.pose.y) : goal.place;
  std::string text = fmt::format("goal {}/{} {}", mission_.current_goal() + 1, scenario_.goals.size(), name);
  // the status of the goal before lasts until the planner has heard of this one
  if (mission_.is_interrupted()) {
    return text + ": waits, somebody else sends the robot (" + navigation_word(judge_.navigation()->state) +
           "); goes on 5 s after that has ended";
  }
  if (judge_.navigation() && judge_.navigation()->goal_id == mission_.goal_id()) {
    const navigation_status_t& status = *judge_.navigation();
    text += fmt::format(": {}", navigation_word(status.state));
    if (status.distance_left > 0.0) {
      text += fmt::format(", {:.1f} m left", status.distance_left);
    }
    if (!status.cause.empty()) {
      text += ", " + status.cause;
    }
  }
  return text;
}

std::vector<std::string> DemoDisplay::picture(const std::vector<launcher::CommandState>& processes) const {
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:6.1f} s  {}", judge_.elapsed(), scenario_.name));
  lines.push_back("  believes  " + belief());
  lines.push_back("  does      " + goal());
  if (judge_.truth()) {
    const sim_truth_t& truth = *judge_.truth();
    lines.push_back(fmt::format(
        "  truth     ({:6.2f}, {:6.2f}, {:4.0f} deg) at {:.2f} m/s, {:.2f} m clear, {} contacts", truth.x, truth.y,
        degrees(truth.theta), truth.linear, truth.clearance, truth.contacts + truth.hard_contacts));
  }
  lines.push_back(fmt::format("  {:<12} {:<10} {:>6} {:>8} {:>8}", "process", "state", "cpu", "memory", "restarts"));
  for (const launcher::CommandState& process : processes) {
    if (process.condition == launcher::Condition::kStopped) {
      continue;  // not part of this run
    }
    lines.push_back(fmt::format("  {:<12} {:<10} {:>4.0f} % {:>5.0f} MB {:>8}  {}", process.name,
                                launcher::to_string(process.condition), 100.0 * process.core_cpu.value_or(0.0),
                                static_cast<double>(process.memory_bytes) / 1e6, process.restarts, process.detail));
  }
  return lines;
}

std::string DemoDisplay::line(const std::vector<launcher::CommandState>& processes) const {
  std::string text = fmt::format("{:6.1f} s  {} | {}", judge_.elapsed(), belief(), goal());
  for (const launcher::CommandState& process : processes) {
    if (process.condition != launcher::Condition::kReady && process.condition != launcher::Condition::kStopped) {
      text += fmt::format(" | {} {} {}", process.name, launcher::to_string(process.condition), process.detail);
    }
  }
  return text;
}

void DemoDisplay::update(const std::vector<launcher::CommandState>& processes) {
  const double now = judge_.elapsed();
  if (!in_place_) {
    const std::string state =
        fmt::format("{} {} {}", judge_.pose() ? int{judge_.pose()->state} : -1,
                    judge_.navigation() ? int{judge_.navigation()->state} : -1, mission_.current_goal());
    if (state == shown_state_ && now - shown_at_ < kLineEvery) {
      return;
    }
    shown_state_ = state;
    shown_at_ = now;
    fmt::print("{}\n", line(processes));
    std::fflush(stdout);
    return;
  }
  if (now - shown_at_ < kRefresh) {
    return;
  }
  shown_at_ = now;
  if (lines_on_screen_ > 0) {
    fmt::print("\x1b[{}A", lines_on_screen_);
  }
  const std::vector<std::string> lines = picture(processes);
  for (const std::string& text : lines) {
    fmt::print("\x1b[2K{}\n", text.substr(0, 150));
  }
  lines_on_screen_ = lines.size();
  std::fflush(stdout);
}

void DemoDisplay::finish() {
  lines_on_screen_ = 0;
}

}  // namespace luminav
