#pragma once

#include <filesystem>

#include "services/launcher/command_words.hpp"

namespace luminav::launcher {

struct StartedChild {
  int pid = 0;
  int terminal = -1;  // our end of the child's terminal
};

/// Forks and executes a program as the leader of a new session behind a new terminal: all signals at their defaults and
/// unblocked, no descriptor but the terminal, SIGTERM when the deputy dies. Throws std::runtime_error when the system
/// has no terminal or process left.
StartedChild start_child(const CommandWords& command, const std::filesystem::path& program_folder);

}  // namespace luminav::launcher
