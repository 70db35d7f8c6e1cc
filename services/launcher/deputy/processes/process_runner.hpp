#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/launcher/command_words.hpp"

namespace luminav::launcher {

struct ProcessUsage {
  std::int64_t cpu = 0;  // [us] used since it started, descendants included
  std::int64_t virtual_bytes = 0;
  std::int64_t resident_bytes = 0;
};

struct MachineUsage {
  std::int64_t cpu_busy = 0;                                                      // [ticks] since boot, all processors
  std::int64_t cpu_total = 0;                                                     // [ticks]
  std::int64_t memory_total = 0, memory_free = 0, swap_total = 0, swap_free = 0;  // [bytes]
};

struct ProcessExit {
  int pid = 0;
  int status = 0;  // raw wait status
};

struct ProcessOutput {
  int pid = 0;
  std::string text;
};

/// Where a deputy's children live: the operating system, or a table in a test.
class ProcessRunner {
 public:
  virtual ~ProcessRunner() = default;
  /// Starts a program in a session of its own and returns its pid. Throws std::runtime_error when the system refuses;
  /// a program that does not exist starts and ends with exit 255, as procman's does.
  virtual int start(const CommandWords& command) = 0;
  /// To the child and to all of its descendants.
  virtual void signal(int pid, int signal) = 0;
  /// Output since the last call. To be taken before the exits: it belongs to processes that still have a name.
  virtual std::vector<ProcessOutput> take_output() = 0;
  /// Children that have ended since the last call; what they left behind is killed.
  virtual std::vector<ProcessExit> take_exits() = 0;
  [[nodiscard]] virtual ProcessUsage usage(int pid) = 0;
  [[nodiscard]] virtual MachineUsage machine() = 0;
  [[nodiscard]] virtual int processors() const = 0;
};

}  // namespace luminav::launcher
