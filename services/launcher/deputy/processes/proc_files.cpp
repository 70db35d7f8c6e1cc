#include "services/launcher/deputy/processes/proc_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

namespace luminav::launcher {

std::optional<ProcessStat> parse_process_stat(const std::string& line) {
  const std::size_t end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos) {
    return std::nullopt;
  }
  std::istringstream fields(line.substr(end_of_name + 1));
  ProcessStat stat;
  std::int64_t group = 0, user = 0, system = 0, resident_pages = 0;
  std::string skipped;
  fields >> stat.state >> stat.parent >> group >> stat.session;
  // terminal, its group, flags, four fault counters: see proc(5)
  for (int i = 0; i < 7; ++i) {
    fields >> skipped;
  }
  fields >> user >> system;
  // children's times, priority, nice, threads, timer, start
  for (int i = 0; i < 7; ++i) {
    fields >> skipped;
  }
  fields >> stat.virtual_bytes >> resident_pages;
  if (!fields) {
    return std::nullopt;
  }
  stat.cpu = (user + system) * 1'000'000 / sysconf(_SC_CLK_TCK);
  stat.resident_bytes = resident_pages * sysconf(_SC_PAGESIZE);
  return stat;
}

std::optional<ProcessStat> read_process_stat(int pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string line;
  return std::getline(file, line) ? parse_process_stat(line) : std::nullopt;
}

std::vector<int> children_of(int pid) {
  std::vector<int> children;
  std::error_code error;
  for (std::filesystem::directory_iterator task(fmt::format("/proc/{}/task", pid), error), end; !error && task != end;
       task.increment(error)) {
    std::ifstream file(task->path() / "children");
    for (int child = 0; file >> child;) {
      children.push_back(child);
    }
  }
  return children;
}

std::vector<int> descendants_of(int pid) {
  std::vector<int> found = children_of(pid);
  // grows while it is walked
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::vector<int> children = children_of(found[i]);
    found.insert(found.end(), children.begin(), children.end());
  }
  return found;
}

MachineUsage read_machine_usage() {
  MachineUsage usage;
  std::ifstream stat("/proc/stat");
  std::string word;
  stat >> word;
  for (int field = 0; field < 8; ++field) {
    std::int64_t ticks = 0;
    if (!(stat >> ticks)) {
      break;
    }
    usage.cpu_total += ticks;
    constexpr int kIdle = 3, kWaitingForDisk = 4;
    usage.cpu_busy += field == kIdle || field == kWaitingForDisk ? 0 : ticks;
  }
  std::ifstream memory("/proc/meminfo");
  for (std::string line; std::getline(memory, line);) {
    std::istringstream fields(line);
    std::int64_t kilobytes = 0;
    fields >> word >> kilobytes;
    if (word == "MemTotal:") {
      usage.memory_total = kilobytes * 1024;
    } else if (word == "MemFree:") {
      usage.memory_free = kilobytes * 1024;
    } else if (word == "SwapTotal:") {
      usage.swap_total = kilobytes * 1024;
    } else if (word == "SwapFree:") {
      usage.swap_free = kilobytes * 1024;
    }
  }
  return usage;
}

}  // namespace luminav::launcher
