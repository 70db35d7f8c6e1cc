#include "tests/system/faults/torture/torture_round.hpp"

#include <fmt/format.h>
#include <sys/mount.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <luminav/motors_command_t.hpp>
#include <stdexcept>

#include "services/common/process/channels.hpp"
#include "tests/system/faults/torture/torture_scenario.hpp"

namespace luminav {
namespace {

constexpr double kCommandTimeout = 0.3;     // [s] without commands, then the driver brakes
constexpr double kWatchdog = 2.0;           // [s] of the robot as delivered: all that is left when its line is cut
constexpr double kMargin = 0.15;            // [s]
constexpr double kLostCommands = 0.1;       // [s] of two in a row, amid loss
constexpr std::int64_t kInFlight = 50'000;  // [us] messages of a process that has just died may still arrive
constexpr double kPersonNear = 1.6;         // [m] then it may wait for the person
constexpr int kMemoryLimit = 250;           // [MB] of a process
constexpr double kSayWithin = 2.0 + 0.3;    // [s] and what a busy machine takes
constexpr double kSonarWay = 3.5;           // [m] for walls to come by that a dead sonar does not hear
constexpr double kWheelWay = 1.5;           // [m]
constexpr double kDriving = 0.15;           // [m/s]

bool mount_small_disk(const std::filesystem::path& folder) {
  return mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=24m") == 0;
}

double seconds(std::int64_t from, std::int64_t to) {
  return static_cast<double>(to - from) * 1e-6;
}

}  // namespace

TortureRound::TortureRound(const RoundPlan& plan) : plan_(plan), random_(plan.seed + 77) {
  const std::filesystem::path state = plan_.folder / "robot";
  std::filesystem::create_directories(state);
  if (plan_.means.full_disk && !mount_small_disk(state)) {
    throw std::runtime_error(fmt::format("{}: no file system can be mounted there", state.string()));
  }
  write_torture_scenario(plan_.folder / "scenario.toml", {plan_.seed, plan_.minutes, plan_.only});
  scenario_ = read_scenario(plan_.folder / "scenario.toml");
  limits_ = read_robot(scenario_.robot_file).limits;
  const auto leaking = [&](const std::string& process) {
    return fmt::format("LD_PRELOAD={} LUMINAV_LEAK={}", LUMINAV_LEAKING, (plan_.folder / ("leak-" + process)).string());
  };
  fleet_ =
      std::make_unique<Fleet>(FleetPlan{.scenario = scenario_,
                                        .folder = plan_.folder,
                                        .pty = plan_.pty,
                                        .placed = {{"simulator", "world"}},
                                        .preload = {{"mapper", leaking("mapper")}, {"detector", leaking("detector")}}});
  fleet_->add_host("world", nullptr, {});
  fleet_->add_host("robot", nullptr, {}, kMemoryLimit);
}

TortureRound::~TortureRound() {
  mission_.reset();
  robot_.reset();
  truth_.reset();
  fleet_.reset();
  if (plan_.means.full_disk) {
    std::error_code ignored;  // the logs, for a person who kept the folder
    std::filesystem::copy(plan_.folder / "robot", plan_.folder / "robot-kept", std::filesystem::copy_options::recursive,
                          ignored);
    umount2((plan_.folder / "robot").c_str(), MNT_DETACH);
  }
}

bool TortureRound::time_is_over() const {
  return truth_->elapsed() > 60.0 * plan_.minutes || mission_->is_finished();
}

bool TortureRound::unplugged() const {
  return truth_->newest() && (truth_->newest()->serial_unplugged || truth_->newest()->camera_unplugged);
}

double TortureRound::simulated_time() const {
  return truth_->newest() ? seconds(truth_->newest()->session, truth_->newest()->utime) : 0.0;
}

const ScenarioEvent* TortureRound::dead_sense() const {
  const double now = simulated_time();
  const auto event = std::find_if(scenario_.events.begin(), scenario_.events.end(), [now](const ScenarioEvent& each) {
    return sense_of(each) != nullptr && now >= each.at && now < each.at + each.duration;
  });
  return event != scenario_.events.end() ? &*event : nullptr;
}

void TortureRound::run(FaultDeck& deck, std::vector<FaultResult>& results, GoalTally& goals) {
  truth_ = std::make_unique<TruthWatch>(fleet_->lcm());
  robot_ = std::make_unique<RobotWatch>(fleet_->lcm(), fleet_->clock());
  const std::int64_t begun = fleet_->clock().utime();
  if (!fleet_->run_script("go")) {
    throw std::runtime_error("the system does not start: " + fleet_->failure());
  }
  fmt::print("round {}: seed {}, robot on {}, all ready after {:.2f} s\n", plan_.number, plan_.seed,
             plan_.pty ? "a terminal" : "TCP", seconds(begun, fleet_->clock().utime()));
  mission_ = std::make_unique<Mission>(fleet_->lcm(), scenario_);
  std::optional<Fault> next = draw(deck);
  while (wait_for(next)) {
    goals.contacts_between_faults += truth_->contacts() - contacts_seen_;
    results.push_back(break_something(next));
    if (!next) {
      next = draw(deck);
    }
  }
  goals.contacts_between_faults += truth_->contacts() - contacts_seen_;
  count_goals(goals);
  fmt::print("round {}: {} goals, {:.0f} m in {:.0f} s\n", plan_.number, mission_->results().size(), truth_->driven(),
             truth_->elapsed());
  fleet_->run_script("stop", 15.0);
}

std::optional<Fault> TortureRound::draw(FaultDeck& deck) const {
  if (!plan_.only.empty() && names_a_dead_sense(plan_.only)) {
    return std::nullopt;
  }
  Fault fault = deck.draw();
  while (to_string(fault).find(plan_.only) == std::string::npos) {
    fault = deck.draw();
  }
  return fault;
}

FaultResult TortureRound::break_something(std::optional<Fault>& next) {
  FaultResult result;
  if (const ScenarioEvent* event = dead_sense()) {
    result = begin({FaultKind::kDeadSense, sense_of(*event)->name, event->duration});
    judge_dead_sense(result, *event);
  } else if (unplugged()) {
    result = begin({FaultKind::kUnplug, truth_->newest()->serial_unplugged ? "serial" : "camera", 0.0});
    judge_unplug(result);
  } else {
    result = begin(*next);
    next.reset();
    FaultInjection(*this).inject(result);
  }
  result.contacts = truth_->contacts() - contacts_seen_;
  contacts_seen_ = truth_->contacts();
  result.truth_gap = truth_->take_longest_gap();
  print(result);
  return result;
}

void TortureRound::print(const FaultResult& result) const {
  const std::string said =
      result.said ? fmt::format(", said after {:.2f}, {:.1f} m: \"{}\"", *result.said, result.way, result.sentence)
                  : "";
  fmt::print("{:7.1f} s {:<22} at {:.2f} m/s {}{}{}{}{}{}{}\n", result.at, to_string(result.fault), result.linear,
             result.stood ? fmt::format("stands after {:.2f}", *result.stood) : "did not stand",
             result.bridged      ? fmt::format(" bridged after {:.2f}", *result.bridged)
             : result.must_stand ? fmt::format(" (at most {:.2f})", result.bound)
                                 : "",
             result.back ? fmt::format(", ready after {:.2f}", *result.back) : "", said,
             result.resumed ? fmt::format(", moves {:.2f} later", *result.resumed) : "",
             result.contacts > 0 ? fmt::format(", {} contacts, {} of them blind, the last {}", result.contacts,
                                               result.blind_contacts, truth_->last_contact())
                                 : "",
             result.good() ? "" : fmt::format("  WRONG: {}", result.remark));
  std::fflush(stdout);
}

void TortureRound::count_goals(GoalTally& goals) const {
  for (const GoalResult& goal : mission_->results()) {
    ++(goal.reached ? goals.reached : goals.missed);
    if (!goal.reached) {
      goals.causes.push_back(fmt::format("round {} ({:.1f}, {:.1f}): {:.2f} m beside it, {}", plan_.number, goal.x,
                                         goal.y, goal.error_m, goal.cause));
    }
  }
}

// A deputy starts a process that dies by itself eight times in a row, and calls what has lived for 10 s recovered. So
// the same one is not broken more often: a crash loop shall end.
bool TortureRound::is_settled(const std::string& process) const {
  constexpr double kRecovered = 11.0;  // [s]
  const std::int64_t started = fleet_->started(process);
  return started == 0 || seconds(started, fleet_->clock().utime()) > kRecovered;
}

bool TortureRound::wait_for(const std::optional<Fault>& next) {
  std::uniform_real_distribution<double> pause(1.0, 5.0);
  const double wanted = pause(random_);  // [s] of good driving
  std::int64_t since = 0;
  std::int64_t shown = fleet_->clock().utime();
  while (!time_is_over()) {
    fleet_->pump();
    const std::int64_t now = fleet_->clock().utime();
    if (unplugged() || dead_sense() != nullptr) {
      return true;
    }
    if (!next) {
      continue;  // it comes by itself
    }
    const bool event_soon =
        std::any_of(scenario_.events.begin(), scenario_.events.end(), [&](const ScenarioEvent& event) {
          return event.at > truth_->elapsed() - 1.0 && event.at < truth_->elapsed() + 9.0;
        });
    const std::vector<std::string> processes = fleet_->processes();
    const bool all_run = std::all_of(processes.begin(), processes.end(),
                                     [&](const std::string& process) { return fleet_->pid(process) > 0; });
    const bool good = all_run && robot_->is_following() && robot_->is_tracking() &&
                      robot_->navigation()->distance_left > 2.0 && std::abs(truth_->newest()->linear) > 0.15;
    since = good ? (since == 0 ? now : since) : 0;
    if (good && !event_soon && seconds(since, now) > wanted && is_settled(next->target)) {
      return true;
    }
    if (seconds(shown, now) > 15.0) {
      shown = now;
      fmt::print("{:7.1f} s {}\n", truth_->elapsed(), robot_->sentence());
      std::fflush(stdout);
    }
  }
  return false;
}

void TortureRound::measure_speed(FaultResult& result) const {
  result.linear = truth_->newest()->linear;
  result.angular = truth_->newest()->angular;
  result.bound = (result.fault.kind == FaultKind::kUnplug ? kWatchdog : kCommandTimeout) + kMargin +
                 (result.fault.kind == FaultKind::kKillLossy ? kLostCommands : 0.0) +
                 std::max(std::abs(result.linear) / limits_.linear_deceleration,
                          std::abs(result.angular) / limits_.angular_acceleration);
}

FaultResult TortureRound::begin(const Fault& fault) {
  FaultResult result;
  result.fault = fault;
  result.round = plan_.number;
  result.at = truth_->elapsed();
  measure_speed(result);
  result.must_stand = breaks_the_chain(fault);
  contacts_seen_ = truth_->contacts();
  truth_->take_longest_gap();
  fault_at_ = fleet_->clock().utime();
  return result;
}

void TortureRound::judge_unplug(FaultResult& result) {
  result.must_stand = result.must_stand && !truth_->stands();
  const std::int64_t bound = fault_at_ + static_cast<std::int64_t>(result.bound * 1e6);
  const auto count_blind_contacts = [&] {
    if (result.fault.target == "serial" && fleet_->clock().utime() < bound) {
      result.blind_contacts = truth_->contacts() - contacts_seen_;
    }
  };
  fleet_->pump_until(
      [&] {
        count_blind_contacts();
        return !unplugged();
      },
      20.0);
  const std::int64_t plugged = fleet_->clock().utime();
  result.fault.duration = seconds(fault_at_, plugged);
  if (result.fault.target == "camera") {
    settle(result, plugged);
    return;
  }
  // The driver looks for its line with growing pauses.
  fleet_->pump_until(
      [&] {
        count_blind_contacts();
        return robot_->connected_after(plugged).has_value();
      },
      20.0);
  const auto connected = robot_->connected_after(plugged);
  if (!connected) {
    judge_standing(result);
    result.remark = "the driver does not find its line again; " + robot_->sentence();
    return;
  }
  settle(result, *connected);
}

void TortureRound::judge_dead_sense(FaultResult& result, const ScenarioEvent& event) {
  const DeadSense& sense = *sense_of(event);
  const bool is_wheel = event.kind == EventKind::kFreeze && event.device != "camera";
  const bool is_sonar = event.kind == EventKind::kDeafen || event.kind == EventKind::kStick;
  const double before = truth_->driven();
  const std::int64_t end = fault_at_ + static_cast<std::int64_t>(1e6 * event.duration);
  if (std::abs(result.linear) > kDriving || !(is_wheel || is_sonar)) {  // else nothing can be learnt of them
    result.say_bound = is_sonar ? event.duration : kSayWithin;
    result.way_bound = is_sonar ? kSonarWay : is_wheel ? kWheelWay : 0.0;
    result.must_stand = is_wheel;
  }
  result.bound = kSayWithin + kMargin + limits_.linear / limits_.linear_deceleration;
  std::int64_t last = fault_at_;
  fleet_->pump_until(
      [&] {
        const std::int64_t now = fleet_->clock().utime();
        if (is_wheel && result.must_stand && !result.said && std::abs(truth_->newest()->linear) < kDriving) {
          result.say_bound += seconds(last, now);  // of a wheel that is not told to turn nothing can be learnt
        }
        last = now;
        const auto status = fleet_->statuses().find(sense.process);
        if (!result.said && status != fleet_->statuses().end() &&
            status->second.state >= node_status_t::STATE_DEGRADED) {
          result.said = seconds(fault_at_, now);
          result.sentence = status->second.reason;
        }
        return now > end;
      },
      60.0);
  result.way = truth_->driven() - before;
  if (is_sonar && result.way < 0.5 * kSonarWay && !result.said) {
    result.say_bound = 0.0;  // it stood for somebody: nothing could be learnt
  }
  if (is_wheel) {
    request_motors();
  }
  settle(result, end);
  if (!result.is_said_in_time()) {
    result.remark = "nobody named it in time; " + robot_->sentence();
  } else if (result.way_bound > 0.0 && result.way > result.way_bound) {
    result.remark = fmt::format("drove {:.1f} m, at most {:.1f}", result.way, result.way_bound);
  }
}

void TortureRound::request_motors() {
  motors_command_t request{};
  request.utime = request.id = fleet_->clock().utime();
  request.enable = 1;
  for (int i = 0; i < 5; ++i) {
    fleet_->lcm().publish(channels::kMotorsCommand, &request);
    fleet_->pump_for(0.2);
  }
}

std::optional<std::int64_t> TortureRound::ready_after(const Victims& victims) const {
  std::int64_t last = fault_at_;
  for (std::size_t i = 0; i < victims.names.size(); ++i) {
    const pid_t pid = fleet_->pid(victims.names[i]);
    const auto heard = fleet_->heard_after(victims.names[i], std::max(fault_at_, fleet_->started(victims.names[i])));
    if (pid == 0 || pid == victims.pids[i] || !heard) {
      return std::nullopt;
    }
    last = std::max(last, *heard);
  }
  return last;
}

void TortureRound::judge_standing(FaultResult& result) {
  const std::int64_t bound = fault_at_ + static_cast<std::int64_t>(result.bound * 1e6);
  fleet_->pump_until([&] { return fleet_->clock().utime() > bound + 300'000; }, 30.0);
  // Commands that came again in time: then nothing has to stand.
  const bool may_bridge = result.fault.kind == FaultKind::kKill || result.fault.kind == FaultKind::kRestart ||
                          result.fault.kind == FaultKind::kKillLossy;
  if (result.must_stand && may_bridge && result.fault.target != "p3dx") {
    const auto again = result.fault.target == "localizer" ? robot_->tracked_after(fault_at_ + kInFlight)
                                                          : robot_->commanded_after(fault_at_ + kInFlight);
    if (again && *again < bound) {
      result.bridged = seconds(fault_at_, *again);
    }
  }
  if (result.must_stand && result.fault.kind == FaultKind::kUnplug && result.back.value_or(60.0) < result.bound) {
    result.bridged = result.back;  // the line was whole again before the robot's watchdog
  }
  if (const auto stood = truth_->stood_at(fault_at_)) {
    result.stood = seconds(fault_at_, *stood);
  }
  if (!result.stands_in_time()) {
    result.remark = "too late to stand; " + robot_->sentence();
  }
}

void TortureRound::settle(FaultResult& result, std::int64_t back) {
  result.back = seconds(fault_at_, back);
  fleet_->pump_until([&] { return fleet_->clock().utime() > back + 300'000; }, 30.0);
  judge_standing(result);
  const auto stood = truth_->stood_at(fault_at_);
  if (!stood) {
    result.needs_no_resume = true;
    return;
  }
  const std::int64_t base = std::max(back, *stood);
  bool person = false;
  fleet_->pump_until(
      [&] {
        person = person || truth_->nearest_person() < kPersonNear;
        return truth_->moved_at(base).has_value() || time_is_over();
      },
      15.0);
  const auto moved = truth_->moved_at(*stood);
  if (moved) {
    result.resumed = std::max(0.0, seconds(back, *moved));
  }
  result.needs_no_resume = (person || time_is_over()) && !result.resumes_in_time();
  if (!result.resumes_in_time()) {
    result.remark = "too late to go on; " + robot_->sentence();
  }
}

bool can_mount_small_disk(const std::filesystem::path& folder) {
  const std::filesystem::path attempt = folder / "small-disk";
  std::filesystem::create_directories(attempt);
  const bool mounted = mount_small_disk(attempt);
  if (mounted) {
    umount2(attempt.c_str(), MNT_DETACH);
  }
  std::filesystem::remove(attempt);
  return mounted;
}

}  // namespace luminav
