#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/launcher/deputy/processes/process_runner.hpp"

namespace luminav::launcher {

/// What /proc/PID/stat says of one process.
struct ProcessStat {
  char state = '?';
  int parent = 0;
  int session = 0;
  std::int64_t cpu = 0;  // [us] of its own
  std::int64_t virtual_bytes = 0;
  std::int64_t resident_bytes = 0;
};

/// Parses a line of /proc/PID/stat; the name in it may hold blanks and brackets.
[[nodiscard]] std::optional<ProcessStat> parse_process_stat(const std::string& line);
[[nodiscard]] std::optional<ProcessStat> read_process_stat(int pid);

/// Children of a process, whichever of its threads made them.
[[nodiscard]] std::vector<int> children_of(int pid);
/// Children, their children and so on.
[[nodiscard]] std::vector<int> descendants_of(int pid);

[[nodiscard]] MachineUsage read_machine_usage();

}  // namespace luminav::launcher
