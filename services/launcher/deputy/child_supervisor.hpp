#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "services/launcher/command_words.hpp"
#include "services/launcher/deputy/deputy_journal.hpp"
#include "services/launcher/deputy/managed_command.hpp"
#include "services/launcher/deputy/processes/process_runner.hpp"
#include "services/launcher/instant.hpp"

namespace luminav::launcher {

struct ChildSupervisorParams {
  RespawnParams respawn;
  std::int64_t memory_limit = 0;  // [bytes] resident; a process that uses more is ended, 0 = none
  Environment environment = [](const std::string&) { return std::nullopt; };
};

/// The life of a deputy's children, whoever ordered them: started, stopped step by step, started again when they end by
/// themselves, measured once a second.
class ChildSupervisor {
 public:
  /// Throws std::invalid_argument for parameters of respawning that make no sense.
  ChildSupervisor(const ChildSupervisorParams& params, ProcessRunner& runner, DeputyJournal& journal);

  /// All that were ever ordered and not yet dropped, by name.
  [[nodiscard]] std::map<std::string, ManagedCommand>& commands() { return commands_; }
  [[nodiscard]] const std::map<std::string, ManagedCommand>& commands() const { return commands_; }
  ManagedCommand& add(const std::string& id);
  void start(const Instant& now, ManagedCommand& command);
  /// The stop signal, and later SIGKILL: to be called again until the child has ended (tick does).
  void stop(const Instant& now, ManagedCommand& command);

  /// Takes in what children printed and which have ended, and does what is due.
  void tick(const Instant& now);
  /// Stops all children; none is started again.
  void stop_all(const Instant& now);
  [[nodiscard]] bool all_stopped() const;

  /// The sheriff should know at once; asking clears it.
  [[nodiscard]] bool take_change();
  void note_change() { changed_ = true; }
  [[nodiscard]] const MachineUsage& machine() const { return machine_; }
  [[nodiscard]] float cpu_load() const { return cpu_load_; }  // 0..1 of the whole machine

 private:
  void collect_children(const Instant& now);
  void take_output(const Instant& now);
  void on_exit(const Instant& now, ManagedCommand& command, int status);
  /// Plans the next start of what died after `lived` [us], or could not even be started, or gives it up.
  void respawn_after(const Instant& now, ManagedCommand& command, std::int64_t lived, const std::string& what);
  void run_timers(const Instant& now);
  void measure(const Instant& now);
  void end_if_too_big(const Instant& now, ManagedCommand& command);
  [[nodiscard]] std::map<std::string, ManagedCommand>::iterator find(int pid);

  ChildSupervisorParams params_;
  ProcessRunner& runner_;
  DeputyJournal& journal_;
  std::map<std::string, ManagedCommand> commands_;
  bool changed_ = false;
  bool shutting_down_ = false;
  MachineUsage machine_;
  float cpu_load_ = 0.0F;
  std::int64_t last_measurement_ = 0;  // [us] steady
};

}  // namespace luminav::launcher
