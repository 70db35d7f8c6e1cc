// What goes wrong, done: the other half of TortureRound.
#include "tests/system/faults/torture/torture_injection.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <fstream>
#include <luminav/stop_t.hpp>
#include <map>
#include <set>

#include "services/common/process/channels.hpp"
#include "tests/system/faults/interference.hpp"
#include "tests/system/faults/stranger.hpp"
#include "tests/system/faults/torture/torture_round.hpp"

namespace luminav {
namespace {

constexpr int kLcmPort = 7667;  // of the fleet's network
constexpr const char* kLcmUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr int kLossPercent = 10;
constexpr double kPacketsPerSecond = 1e5;  // of a stranger

/// Nothing where there is no process: 0 would be all of this program's group.
void send_signal(pid_t pid, int signal) {
  if (pid > 0) {
    kill(pid, signal);
  }
}

void fill_disk(const std::filesystem::path& ballast) {
  std::ofstream out(ballast);
  const std::string piece(64 << 10, 'x');
  while (out << piece << std::flush) {
  }
}

}  // namespace

void FaultInjection::inject(FaultResult& result) {
  using Step = void (FaultInjection::*)(FaultResult&);
  static const std::map<FaultKind, Step> kSteps = {{FaultKind::kKill, &FaultInjection::kill_victims},
                                                   {FaultKind::kKillAll, &FaultInjection::kill_victims},
                                                   {FaultKind::kKillLossy, &FaultInjection::kill_amid_loss},
                                                   {FaultKind::kReadOnly, &FaultInjection::kill_read_only},
                                                   {FaultKind::kDiskFull, &FaultInjection::kill_on_full_disk},
                                                   {FaultKind::kKillGuardian, &FaultInjection::kill_guardian},
                                                   {FaultKind::kKillDeputy, &FaultInjection::kill_deputy},
                                                   {FaultKind::kKillSheriff, &FaultInjection::kill_sheriff},
                                                   {FaultKind::kKillViewer, &FaultInjection::kill_viewer},
                                                   {FaultKind::kFreeze, &FaultInjection::freeze},
                                                   {FaultKind::kRestart, &FaultInjection::restart},
                                                   {FaultKind::kLeak, &FaultInjection::leak},
                                                   {FaultKind::kStarve, &FaultInjection::starve},
                                                   {FaultKind::kStrangers, &FaultInjection::besiege}};
  (this->*kSteps.at(result.fault.kind))(result);
}

Victims FaultInjection::victims_of(const Fault& fault) const {
  Victims victims;
  if (fault.kind == FaultKind::kKillAll || fault.kind == FaultKind::kKillDeputy ||
      fault.kind == FaultKind::kStrangers) {
    victims.names = fleet().processes();
    std::erase(victims.names, "simulator");
  } else if (!fault.target.empty()) {
    victims.names = {fault.target};
  }
  for (const std::string& name : victims.names) {
    victims.pids.push_back(fleet().pid(name));
  }
  return victims;
}

void FaultInjection::await_return(FaultResult& result, const Victims& victims) {
  constexpr double kPatience = 20.0;  // [s]
  fleet().pump_until([&] { return round_.ready_after(victims).has_value(); }, kPatience);
  if (const auto ready = round_.ready_after(victims)) {
    round_.settle(result, *ready);
    return;
  }
  round_.judge_standing(result);
  result.remark = "not ready again; " + round_.robot_->sentence();
}

void FaultInjection::kill_victims(FaultResult& result) {
  const Victims victims = victims_of(result.fault);
  round_.fault_at_ = now();
  for (const pid_t pid : victims.pids) {
    send_signal(pid, SIGKILL);
  }
  await_return(result, victims);
}

void FaultInjection::kill_amid_loss(FaultResult& result) {
  const PacketLoss loss(kLcmPort, kLossPercent);
  fleet().pump_for(result.fault.duration);
  round_.measure_speed(result);
  kill_victims(result);
}

void FaultInjection::kill_read_only(FaultResult& result) {
  const ReadOnlyFolder read_only(round_.plan_.folder / "robot");
  kill_victims(result);
}

void FaultInjection::kill_on_full_disk(FaultResult& result) {
  constexpr double kUnnoticed = 2.0;  // [s]
  const std::filesystem::path ballast = round_.plan_.folder / "robot" / "ballast";
  fill_disk(ballast);
  fleet().pump_for(kUnnoticed);
  round_.measure_speed(result);
  kill_victims(result);
  fleet().pump_for(result.fault.duration - kUnnoticed);
  std::filesystem::remove(ballast);
}

void FaultInjection::kill_guardian(FaultResult& result) {
  const Victims victims = victims_of(result.fault);
  round_.fault_at_ = now();
  send_signal(child_of(victims.pids.front()), SIGKILL);
  await_return(result, victims);
}

void FaultInjection::kill_deputy(FaultResult& result) {
  const Victims victims = victims_of(result.fault);
  fleet().host("robot").kill_deputy();
  fleet().pump_for(2.0);
  fleet().host("robot").start();
  await_return(result, victims);
}

void FaultInjection::kill_sheriff(FaultResult& result) {
  fleet().replace_sheriff();
  fleet().pump_for(2.0);
  await_return(result, {});
}

void FaultInjection::freeze(FaultResult& result) {
  const pid_t pid = fleet().pid(result.fault.target);
  send_signal(pid, SIGSTOP);
  fleet().pump_for(result.fault.duration);
  send_signal(pid, SIGCONT);
  round_.settle(result, now());
}

void FaultInjection::restart(FaultResult& result) {
  const Victims victims = victims_of(result.fault);
  fleet().sheriff().restart({launcher::Target::Kind::kCommand, result.fault.target});
  await_return(result, victims);
}

void FaultInjection::leak(FaultResult& result) {
  const Victims victims = victims_of(result.fault);
  const std::filesystem::path leak = round_.plan_.folder / ("leak-" + result.fault.target);
  std::ofstream(leak) << "leak\n";
  fleet().pump_until([&] { return fleet().pid(result.fault.target) != victims.pids.front(); }, result.fault.duration);
  std::filesystem::remove(leak);
  await_return(result, victims);
}

void FaultInjection::starve(FaultResult& result) {
  {
    const BusyLoops loops(2);
    fleet().pump_for(result.fault.duration);
  }
  round_.settle(result, now());
}

// What it said once, and was not killed before it said it, holds: until somebody releases it.
void FaultInjection::kill_viewer(FaultResult& result) {
  DoomedViewer viewer({LUMINAV_PROGRAMS "/viewer", "--robot", round_.scenario_.robot_file.string(), "--building",
                       round_.scenario_.building_file.string(), "--lcm-url", kLcmUrl});
  round_.measure_speed(result);  // it has driven on meanwhile
  round_.fault_at_ = now();
  const bool is_answered = viewer.stop_robot();
  viewer.kill_it();
  fleet().pump_for(result.fault.duration);
  const auto stood = round_.truth_->stood_at(round_.fault_at_);
  const bool moved_on = stood && round_.truth_->moved_at(*stood).has_value();
  release_stop();
  round_.settle(result, now());
  if (!is_answered || moved_on) {
    violate(result, is_answered ? "it drove on although nobody had released the stop" : "the viewer did not answer");
  }
}

void FaultInjection::release_stop() {
  stop_t stop{};
  stop.id = stop.utime = now();
  stop.sender = "torture";
  const RobotWatch& robot = *round_.robot_;
  fleet().pump_until(
      [&] {
        if (robot.robot() && robot.control() && robot.robot()->stop_id == stop.id &&
            robot.control()->stop_id == stop.id) {
          return true;
        }
        fleet().lcm().publish(channels::kStop, &stop);
        fleet().pump_for(0.2);
        return false;
      },
      5.0);
}

// First all that he can say, then more than anybody can read. Nothing of it dies, is obeyed or keeps the robot
// standing.
void FaultInjection::besiege(FaultResult& result) {
  const Victims before = victims_of(result.fault);
  Stranger stranger(round_.plan_.neighbour->host(), Neighbour::kOwnAddress);
  std::set<std::int64_t> ids;
  const auto elapsed = [&] { return 1e-6 * static_cast<double>(now() - round_.fault_at_); };
  while (elapsed() < 0.5 * result.fault.duration) {
    ids.insert(now());
    stranger.command_everything(*ids.rbegin());
    stranger.engage_stop(*ids.rbegin());
    stranger.send_every_type();
    fleet().pump();
  }
  const double begun = elapsed();
  const std::int64_t said = stranger.sent();
  while (elapsed() < result.fault.duration) {
    constexpr int kAtOnce = 1000;
    const double due = kPacketsPerSecond * (elapsed() - begun) - static_cast<double>(stranger.sent() - said);
    stranger.send_rubbish(std::clamp(static_cast<int>(0.25 * due), 0, kAtOnce));  // each to two ports of two addresses
    fleet().pump(1);
  }
  fmt::print("          {} words of a stranger, then {:.0f} packets/s\n", said,
             static_cast<double>(stranger.sent() - said) / (elapsed() - begun));
  round_.settle(result, now());
  const RobotWatch& robot = *round_.robot_;
  for (const auto& [id, what] : {std::pair{robot.robot()->stop_id, "stop"},
                                 {robot.robot()->motors_command_id, "motors"},
                                 {robot.navigation()->goal_id, "goal"},
                                 {robot.pose()->initial_pose_id, "pose"}}) {
    if (ids.contains(id)) {
      violate(result, fmt::format("a stranger's {} was obeyed", what));
    }
  }
  if (victims_of(result.fault).pids != before.pids) {
    violate(result, "a stranger ended a process");
  }
}

void FaultInjection::violate(FaultResult& result, const std::string& how) {
  result.violated = true;
  result.remark = how;
}

Fleet& FaultInjection::fleet() const {
  return *round_.fleet_;
}

std::int64_t FaultInjection::now() const {
  return fleet().clock().utime();
}

}  // namespace luminav
