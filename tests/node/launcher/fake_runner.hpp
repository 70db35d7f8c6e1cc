#pragma once

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "services/launcher/deputy/processes/process_runner.hpp"

namespace luminav::launcher {

/// Children that are only a table: they end when they get a signal that they do not ignore, or when the test says so.
class FakeRunner final : public ProcessRunner {
 public:
  int start(const CommandWords& command) override {
    if (failing_starts > 0) {
      --failing_starts;
      throw std::runtime_error("no process to be had");
    }
    started.push_back(command);
    running[++last_pid] = command.words.front();
    return last_pid;
  }
  void signal(int pid, int signal) override {
    signals.emplace_back(pid, signal);
    if (signal == 9 || !stubborn.contains(running[pid])) {
      end(pid, signal);
    }
  }
  std::vector<ProcessOutput> take_output() override { return std::exchange(printed, {}); }
  std::vector<ProcessExit> take_exits() override { return std::exchange(exits_, {}); }
  [[nodiscard]] ProcessUsage usage(int) override {
    return {.cpu = 1000, .virtual_bytes = 2000, .resident_bytes = resident_bytes};
  }
  [[nodiscard]] MachineUsage machine() override {
    return {.cpu_busy = 1, .cpu_total = 2, .memory_total = 10, .memory_free = 5};
  }
  [[nodiscard]] int processors() const override { return 2; }

  /// The child ends with a raw wait status.
  void end(int pid, int status) {
    if (running.erase(pid) > 0) {
      exits_.push_back({pid, status});
    }
  }

  std::map<int, std::string> running;  // pid -> program
  std::set<std::string> stubborn;      // programs that only SIGKILL ends
  std::vector<CommandWords> started;
  std::vector<std::pair<int, int>> signals;  // pid, signal
  std::vector<ProcessOutput> printed;
  int last_pid = 100;
  int failing_starts = 0;              // that many fail from now on
  std::int64_t resident_bytes = 3000;  // of every child

 private:
  std::vector<ProcessExit> exits_;
};

}  // namespace luminav::launcher
