// What goes wrong, done: the other half of TortureRound.
#include <signal.h>

#include <fstream>
#include <luminav/stop_t.hpp>
#include <memory>

#include "services/common/process/channels.hpp"
#include "tests/system/faults/interference.hpp"
#include "tests/system/faults/torture/torture_round.hpp"

namespace luminav {
namespace {

constexpr int kLcmPort = 7667;  // of the fleet's network
constexpr const char* kLcmUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr int kLossPercent = 10;

/// Nothing where there is no process: 0 would be all of this program's group.
void send_signal(pid_t pid, int signal) {
  if (pid > 0) {
    kill(pid, signal);
  }
}

}  // namespace

void TortureRound::fill_disk() {
  std::ofstream ballast(plan_.folder / "robot" / "ballast");
  const std::string piece(64 << 10, 'x');
  while (ballast << piece << std::flush) {
  }
}

void TortureRound::inject(FaultResult& result) {
  const Fault& fault = result.fault;
  std::vector<std::string> victims{fault.target};
  if (fault.kind == FaultKind::kKillAll || fault.kind == FaultKind::kKillDeputy) {
    victims = fleet_->processes();
    std::erase(victims, "simulator");
  } else if (fault.target.empty()) {
    victims.clear();
  }
  std::vector<pid_t> pids;
  for (const std::string& victim : victims) {
    pids.push_back(fleet_->pid(victim));
  }
  const std::unique_ptr<PacketLoss> loss =
      fault.kind == FaultKind::kKillLossy ? std::make_unique<PacketLoss>(kLcmPort, kLossPercent) : nullptr;
  const std::unique_ptr<ReadOnlyFolder> read_only =
      fault.kind == FaultKind::kReadOnly ? std::make_unique<ReadOnlyFolder>(plan_.folder / "robot") : nullptr;
  fleet_->pump_for(loss ? fault.duration : 0.0);
  const std::filesystem::path leak = plan_.folder / ("leak-" + fault.target);
  switch (fault.kind) {
    case FaultKind::kDiskFull:
      fill_disk();
      fleet_->pump_for(2.0);
      result.linear = truth_->newest()->linear;
      [[fallthrough]];
    case FaultKind::kKill:
    case FaultKind::kKillLossy:
    case FaultKind::kReadOnly:
    case FaultKind::kKillAll:
      fault_at_ = fleet_->clock().utime();
      for (const pid_t pid : pids) {
        send_signal(pid, SIGKILL);
      }
      break;
    case FaultKind::kFreeze:
      send_signal(pids.front(), SIGSTOP);
      fleet_->pump_for(fault.duration);
      send_signal(pids.front(), SIGCONT);
      settle(result, fleet_->clock().utime());
      return;
    case FaultKind::kRestart:
      fleet_->sheriff().restart({launcher::Target::Kind::kCommand, fault.target});
      break;
    case FaultKind::kKillDeputy:
      fleet_->host("robot").kill_deputy();
      fleet_->pump_for(2.0);
      fleet_->host("robot").start();
      break;
    case FaultKind::kKillSheriff:
      fleet_->replace_sheriff();
      fleet_->pump_for(2.0);
      break;
    case FaultKind::kLeak:
      std::ofstream(leak) << "leak\n";
      fleet_->pump_until([&] { return fleet_->pid(fault.target) != pids.front(); }, fault.duration);
      std::filesystem::remove(leak);
      break;
    case FaultKind::kKillGuardian:
      fault_at_ = fleet_->clock().utime();
      send_signal(child_of(pids.front()), SIGKILL);
      break;
    case FaultKind::kKillViewer:
      stop_by_a_viewer_that_is_killed(result);
      return;
    case FaultKind::kStarve:
      starve(fault.duration);
      settle(result, fleet_->clock().utime());
      return;
    case FaultKind::kUnplug:
    case FaultKind::kDeadSense:
      break;
  }
  constexpr double kPatience = 20.0;  // [s]
  fleet_->pump_until([&] { return ready_after(victims, pids, fault_at_).has_value(); }, kPatience);
  const auto ready = ready_after(victims, pids, fault_at_);
  if (fault.kind == FaultKind::kDiskFull) {
    fleet_->pump_for(fault.duration - 2.0);
    std::filesystem::remove(plan_.folder / "robot" / "ballast");
  }
  if (!ready) {
    judge_standing(result);
    result.remark = "not ready again; " + robot_->sentence();
    return;
  }
  settle(result, *ready);
}

void TortureRound::starve(double duration) {
  const BusyLoops loops(2);
  fleet_->pump_for(duration);
}

// What it said once, and was not killed before it said it, holds: until somebody releases it.
void TortureRound::stop_by_a_viewer_that_is_killed(FaultResult& result) {
  DoomedViewer viewer({LUMINAV_PROGRAMS "/viewer", "--robot", scenario_.robot_file.string(), "--building",
                       scenario_.building_file.string(), "--lcm-url", kLcmUrl});
  measure_speed(result);  // it has driven on meanwhile
  fault_at_ = fleet_->clock().utime();
  const bool is_answered = viewer.stop_robot();
  viewer.kill_it();
  fleet_->pump_for(result.fault.duration);
  const auto stood = truth_->stood_at(fault_at_);
  const bool moved_on = stood && truth_->moved_at(*stood).has_value();
  release_stop();
  settle(result, fleet_->clock().utime());
  if (!is_answered || moved_on) {
    result.stood.reset();
    result.remark = is_answered ? "it drove on although nobody had released the stop" : "the viewer did not answer";
  }
}

void TortureRound::release_stop() {
  stop_t stop{};
  stop.id = stop.utime = fleet_->clock().utime();
  stop.sender = "torture";
  fleet_->pump_until(
      [&] {
        if (robot_->robot() && robot_->control() && robot_->robot()->stop_id == stop.id &&
            robot_->control()->stop_id == stop.id) {
          return true;
        }
        fleet_->lcm().publish(channels::kStop, &stop);
        fleet_->pump_for(0.2);
        return false;
      },
      5.0);
}

}  // namespace luminav
