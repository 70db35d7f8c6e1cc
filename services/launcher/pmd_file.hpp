#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace luminav::launcher {

/// One process of a configuration: what to run, where, and how to end it.
struct Command {
  std::string name;                // unique over all deputies
  std::string exec;                // command line, variables not yet expanded
  std::string deputy;              // id of the deputy that runs it
  std::string group;               // "" or "outer/inner"
  bool auto_respawn = false;       // start it again when it ends by itself
  int stop_signal = 2;             // 1..64
  double stop_time_allowed = 7.0;  // [s] from the stop signal to SIGKILL
  int line = 0;                    // in the file
};

/// What an action is about; a group means its subgroups too.
struct Target {
  enum class Kind { kEverything, kCommand, kGroup };
  Kind kind = Kind::kEverything;
  std::string name;
};

/// "everything", `command "x"` or `group "y"`, as a sentence would say it.
std::string to_string(const Target& target);

enum class AwaitedStatus { kRunning, kStopped };

/// One line of a script.
struct Action {
  enum class Kind { kStart, kStop, kRestart, kWaitTime, kWaitStatus, kRunScript };
  Kind kind = Kind::kStart;
  Target target;                       // start, stop, restart, wait for a status
  std::optional<AwaitedStatus> await;  // wait until all of the target has it
  double seconds = 0.0;                // [s] wait for a time
  std::string script;                  // run_script
  int line = 0;
};

struct Script {
  std::string name;
  std::vector<Action> actions;
  int line = 0;
};

/// A configuration in procman's grammar.
struct PmdFile {
  std::string file;
  std::vector<Command> commands;  // in the order of the file
  std::vector<Script> scripts;

  [[nodiscard]] const Script* find_script(std::string_view name) const;
  [[nodiscard]] const Command* find_command(std::string_view name) const;
  [[nodiscard]] bool has_group(std::string_view name) const;
};

[[nodiscard]] bool is_in_group(std::string_view group_of_command, std::string_view group);

/// Reads a configuration. Throws ConfigurationError as "file:line: found this, expected that"; a command, script or
/// attribute given twice, a script that names what does not exist, scripts that run each other in a circle and a script
/// that comes to more than 10,000 actions are errors.
PmdFile parse_pmd(std::string_view text, const std::string& file_name);
PmdFile read_pmd(const std::filesystem::path& file);

}  // namespace luminav::launcher
