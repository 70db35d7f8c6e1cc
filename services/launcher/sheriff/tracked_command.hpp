#pragma once

#include <cstdint>
#include <luminav/node_status_t.hpp>
#include <luminav_procman/procman_command_status_t.hpp>
#include <map>
#include <optional>
#include <string>

#include "services/launcher/pmd_file.hpp"

namespace luminav::launcher {

/// What a person wants to know of a process first.
enum class Condition {
  kUnknown,     // its deputy has not said anything of it
  kStopped,     // not started, ended well, or stopped by order
  kStarting,    // order sent, or running and not yet ready
  kReady,       // says READY; programs that are not ours: has run for a second
  kDegraded,    // says DEGRADED
  kFault,       // says FAULT
  kSilent,      // was ready, runs, and has said nothing for three seconds
  kStopping,    // order sent
  kRestarting,  // died or was told to, and will run again
  kFailed,      // ended badly and stays stopped
  kGaveUp,      // restarted too often in a row
  kRefused,     // the deputy may not run it
};

/// One word for a table.
std::string to_string(Condition condition);
/// Does its work, be it with a shortcoming that it names: what a script waits for.
[[nodiscard]] bool is_running(Condition condition);

/// A process at one moment, for tables and reports.
struct CommandState {
  std::string name;
  std::string group;
  std::string deputy;
  Condition condition = Condition::kUnknown;
  std::string detail;               // why, in plain words; "" when there is nothing to say
  int pid = 0;                      // 0 = stopped
  int exit_code = 0;                // raw wait status of the last run
  bool finished = false;            // a program that runs once has done its work
  std::optional<double> core_cpu;   // of one core, from NODE_STATUS
  double machine_cpu = 0.0;         // 0..1 of the whole machine, from its deputy
  std::int64_t memory_bytes = 0;    // resident
  int restarts = 0;                 // seen since this sheriff watches
  double uptime = 0.0;              // [s]
  bool uptime_at_least = false;     // it ran before this sheriff watched
  std::int64_t dropped_inputs = 0;  // from NODE_STATUS
};

/// A command with what is wanted of it and what was heard of it.
class TrackedCommand {
 public:
  enum class Wish { kNone, kStart, kStop, kRestart };

  /// A command of the configuration, or one that a deputy was found running.
  explicit TrackedCommand(const Command& command);
  TrackedCommand(const luminav_procman::procman_command_status_t& found, std::string deputy);

  /// Takes the deputy's word: adopts what runs when it is heard for the first time, then carries out a wish that came
  /// before. Nothing = the deputy does not list the command. True when orders should go out.
  bool update(const std::optional<luminav_procman::procman_command_status_t>& status, std::int64_t steady_now);
  /// Takes the word of a process of its name, on whichever host; `host` says which one counts.
  void update(const node_status_t& status, std::int64_t steady_now);
  /// Another sheriff's orders: that is what is wanted from now on.
  void adopt_orders(std::int32_t desired_runid, bool force_quit);

  void start();
  void stop();
  void restart();

  [[nodiscard]] CommandState state(bool deputy_heard, std::int64_t steady_now) const;
  /// Stopped as the deputy sees it and as ordered; one that was never started counts.
  [[nodiscard]] bool is_stopped() const;

  luminav_procman::procman_command_t command{};  // as it goes into the orders
  std::string deputy;
  std::string process;        // what it calls itself in NODE_STATUS
  std::string host;           // where its deputy runs; "" = not known
  bool has_namesake = false;  // another one there calls itself by the same name
  bool configured = false;
  bool removing = false;  // left out of the orders until the deputy has forgotten it
  std::int32_t desired_runid = 0;
  bool force_quit = false;

  [[nodiscard]] int pid() const { return status_ ? status_->pid : 0; }
  [[nodiscard]] bool is_listed() const { return status_.has_value(); }

 private:
  /// A NODE_STATUS and when it was heard.
  struct Word {
    node_status_t status;
    std::int64_t at = 0;  // [us] steady
  };
  /// The newest of its own host; nullptr = none, or several hosts speak and which is meant is not known.
  [[nodiscard]] const Word* word() const;
  [[nodiscard]] std::string why_unknown() const;
  void adopt(std::int64_t steady_now);
  [[nodiscard]] bool decide(const luminav_procman::procman_command_status_t& status, std::int64_t steady_now);
  void apply(Wish wish);
  void note_run(const luminav_procman::procman_command_status_t& status, std::int64_t steady_now);
  [[nodiscard]] Condition condition(bool deputy_heard, std::int64_t steady_now, std::string& detail) const;
  [[nodiscard]] Condition running_condition(std::int64_t steady_now, std::string& detail) const;
  [[nodiscard]] Condition stopped_condition(std::string& detail) const;

  bool announces_itself_ = false;
  bool adopted_ = false;
  std::optional<std::int64_t> undecided_since_;  // [us] steady
  Wish wish_ = Wish::kNone;                      // until the deputy is heard
  std::optional<luminav_procman::procman_command_status_t> status_;
  std::map<std::string, Word> words_;  // of this run, by host
  std::int64_t running_since_ = 0;     // [us] steady
  bool saw_start_ = false;
  int last_pid_ = 0;  // of the newest run
  std::int32_t last_runid_ = 0;
  int restarts_ = 0;
};

}  // namespace luminav::launcher
