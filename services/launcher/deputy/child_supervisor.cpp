#include "services/launcher/deputy/child_supervisor.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <utility>

#include "services/launcher/exit_status.hpp"

namespace luminav::launcher {
namespace {

constexpr std::int64_t kMeasurementPeriod = kSecond;
constexpr double kLongestShutdown = 5.0;  // [s] that a child has to end when the deputy ends

}  // namespace

ChildSupervisor::ChildSupervisor(const ChildSupervisorParams& params, ProcessRunner& runner, DeputyJournal& journal)
    : params_(params), runner_(runner), journal_(journal), machine_(runner.machine()) {
  RespawnPolicy checked(params_.respawn);
}

ManagedCommand& ChildSupervisor::add(const std::string& id) {
  changed_ = true;
  return commands_.emplace(id, ManagedCommand(params_.respawn)).first->second;
}

void ChildSupervisor::start(const Instant& now, ManagedCommand& command) {
  command.actual_runid = command.desired_runid;
  command.stop_sent.reset();
  command.kill_sent = false;
  command.too_big = false;
  command.respawn_at.reset();
  command.usage = {};
  command.cpu_usage = 0.0F;
  changed_ = true;
  const std::string& id = command.command.command_id;
  try {
    const CommandWords words = split_command(command.command.exec_str, params_.environment);
    for (const std::string& name : words.unset) {
      journal_.say(now, fmt::format("\"{}\": the variable {} is not set and stays as written", id, name));
    }
    command.pid = runner_.start(words);
    command.started = now.steady;
    command.exit_code = 0;
    DeputyJournal::note(now, fmt::format("started, pid {}: {}", command.pid, fmt::join(words.words, " ")),
                        command.log.get());
  } catch (const std::exception& error) {
    command.exit_code = 255 << 8;
    journal_.say(now, fmt::format("\"{}\" cannot be started: {}", id, error.what()));
    respawn_after(now, command, 0, error.what());
  }
}

void ChildSupervisor::respawn_after(const Instant& now, ManagedCommand& command, std::int64_t lived,
                                    const std::string& what) {
  if (command.command.auto_respawn == 0) {
    return;
  }
  if (const std::optional<std::int64_t> delay = command.respawn.delay_after(lived)) {
    command.respawn_at = now.steady + *delay;
  } else {
    command.exit_code = kGaveUpStatus;
    journal_.say(
        now, fmt::format("\"{}\" died {} times in a row and stays stopped until it is started again; the last time: {}",
                         command.command.command_id, command.respawn.deaths_in_a_row() + 1, what));
  }
}

void ChildSupervisor::stop(const Instant& now, ManagedCommand& command) {
  if (!command.stop_sent) {
    command.stop_sent = now.steady;
    command.kill_sent = false;
    runner_.signal(command.pid, command.command.stop_signal);
    changed_ = true;
    return;
  }
  const double allowed = shutting_down_ ? std::min<double>(kLongestShutdown, command.command.stop_time_allowed)
                                        : command.command.stop_time_allowed;
  if (static_cast<double>(now.steady - *command.stop_sent) >= allowed * 1e6) {
    if (!command.kill_sent) {
      journal_.say(
          now, fmt::format("\"{}\" did not end within {:.1f} s and is killed", command.command.command_id, allowed));
    }
    command.kill_sent = true;
    runner_.signal(command.pid, SIGKILL);
  }
}

void ChildSupervisor::tick(const Instant& now) {
  collect_children(now);
  run_timers(now);
  if (now.steady - last_measurement_ >= kMeasurementPeriod) {
    measure(now);
  }
}

std::map<std::string, ManagedCommand>::iterator ChildSupervisor::find(int pid) {
  return std::find_if(commands_.begin(), commands_.end(), [pid](const auto& c) { return c.second.pid == pid; });
}

void ChildSupervisor::take_output(const Instant& now) {
  for (const ProcessOutput& printed : runner_.take_output()) {
    if (const auto command = find(printed.pid); command != commands_.end()) {
      journal_.add_output(now, command->first, printed.text, command->second.log.get());
    }
  }
}

void ChildSupervisor::collect_children(const Instant& now) {
  take_output(now);
  const std::vector<ProcessExit> exits = runner_.take_exits();
  take_output(now);  // last words
  for (const ProcessExit& ended : exits) {
    if (const auto command = find(ended.pid); command != commands_.end()) {
      on_exit(now, command->second, ended.status);
      if (command->second.removing && !command->second.running()) {
        commands_.erase(command);
      }
    }
  }
}

void ChildSupervisor::on_exit(const Instant& now, ManagedCommand& command, int status) {
  const std::string& id = command.command.command_id;
  const bool by_order = command.stop_sent.has_value();
  const std::int64_t lived = now.steady - command.started;
  const std::string what = describe_exit(status);
  command.pid = 0;
  command.exit_code = status;
  command.stop_sent.reset();
  command.kill_sent = false;
  changed_ = true;
  DeputyJournal::note(now, "ended: " + what, command.log.get());
  if (shutting_down_ || command.removing || !command.should_run) {
    return;
  }
  if (command.actual_runid != command.desired_runid) {
    start(now, command);  // a restart is one step: the orders for the new run are here already
    return;
  }
  if (!by_order) {
    journal_.say(now,
                 fmt::format("\"{}\" ended by itself after {:.1f} s: {}", id, static_cast<double>(lived) * 1e-6, what));
  }
  respawn_after(now, command, lived, what);
}

void ChildSupervisor::run_timers(const Instant& now) {
  for (auto& [id, command] : commands_) {
    if (command.running() && command.stop_sent) {
      stop(now, command);
    } else if (command.respawn_at && now.steady >= *command.respawn_at) {
      start(now, command);
    }
  }
}

void ChildSupervisor::measure(const Instant& now) {
  const double available = static_cast<double>(now.steady - last_measurement_) * runner_.processors();
  for (auto& [id, command] : commands_) {
    if (!command.running()) {
      continue;
    }
    const ProcessUsage usage = runner_.usage(command.pid);
    const bool first = command.usage.cpu == 0;
    const auto used = static_cast<double>(usage.cpu - command.usage.cpu);
    command.cpu_usage = first ? 0.0F : static_cast<float>(std::clamp(used / available, 0.0, 1.0));
    command.usage = usage;
    end_if_too_big(now, command);
  }
  const MachineUsage machine = runner_.machine();
  const auto total = static_cast<double>(machine.cpu_total - machine_.cpu_total);
  cpu_load_ =
      total > 0 ? static_cast<float>(static_cast<double>(machine.cpu_busy - machine_.cpu_busy) / total) : cpu_load_;
  machine_ = machine;
  last_measurement_ = now.steady;
}

void ChildSupervisor::end_if_too_big(const Instant& now, ManagedCommand& command) {
  if (params_.memory_limit <= 0 || command.usage.resident_bytes <= params_.memory_limit || command.stop_sent) {
    return;
  }
  journal_.say(now,
               fmt::format("\"{}\" uses {} MB, more than the {} MB allowed, and is ended", command.command.command_id,
                           command.usage.resident_bytes / 1'000'000, params_.memory_limit / 1'000'000));
  command.too_big = true;
  stop(now, command);
}

void ChildSupervisor::stop_all(const Instant& now) {
  shutting_down_ = true;
  for (auto& [id, command] : commands_) {
    command.should_run = false;
    command.respawn_at.reset();
    if (command.running() && !command.stop_sent) {
      stop(now, command);
    }
  }
}

bool ChildSupervisor::all_stopped() const {
  return std::none_of(commands_.begin(), commands_.end(), [](const auto& c) { return c.second.running(); });
}

bool ChildSupervisor::take_change() {
  return std::exchange(changed_, false);
}

}  // namespace luminav::launcher
