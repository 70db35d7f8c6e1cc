#include "services/launcher/sheriff/status_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace luminav::launcher {
namespace {

std::string format_row(const CommandState& state, std::size_t name_width) {
  // Of one core where the process says so itself; its deputy only knows the share of the whole machine.
  const std::string cpu = state.pid == 0   ? ""
                          : state.core_cpu ? fmt::format("{:.1f} %", *state.core_cpu * 100)
                                           : fmt::format("{:.1f} %m", state.machine_cpu * 100);
  const std::string memory =
      state.pid == 0 ? "" : fmt::format("{:.1f} MB", static_cast<double>(state.memory_bytes) / 1e6);
  const std::string uptime = state.pid == 0 ? "" : (state.uptime_at_least ? ">" : "") + format_duration(state.uptime);
  return fmt::format("{:<{}}  {:<10}  {:<10}  {:>9}  {:>9}  {:>8}  {:>10}  {}", state.name, name_width, state.deputy,
                     to_string(state.condition), cpu, memory, state.restarts, uptime, state.detail);
}

}  // namespace

std::string format_duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::max(0.0, std::floor(seconds)));
  const std::int64_t minutes = whole / 60;
  const std::int64_t hours = minutes / 60;
  if (hours >= 24) {
    return fmt::format("{}d {:02}:{:02}", hours / 24, hours % 24, minutes % 60);
  }
  if (hours > 0) {
    return fmt::format("{}:{:02}:{:02}", hours, minutes % 60, whole % 60);
  }
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

std::vector<std::string> status_table(const Sheriff& sheriff, std::size_t width) {
  const std::vector<CommandState> states = sheriff.states();
  std::size_t name_width = 7;
  for (const CommandState& state : states) {
    name_width = std::min<std::size_t>(40, std::max(name_width, state.name.size() + (state.group.empty() ? 0 : 2)));
  }
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<{}}  {:<10}  {:<10}  {:>9}  {:>9}  {:>8}  {:>10}  {}", "process", name_width,
                              "deputy", "state", "CPU", "memory", "restarts", "uptime", "why"));
  // Groups in the order of their first command, each under its own line.
  std::vector<std::string> groups;
  for (const CommandState& state : states) {
    if (std::find(groups.begin(), groups.end(), state.group) == groups.end()) {
      groups.push_back(state.group);
    }
  }
  for (const std::string& group : groups) {
    if (!group.empty()) {
      lines.push_back(group);
    }
    for (CommandState state : states) {
      if (state.group == group) {
        state.name = (group.empty() ? "" : "  ") + state.name;
        lines.push_back(format_row(state, name_width));
      }
    }
  }
  for (const DeputyState& deputy : sheriff.deputies()) {
    if (!deputy.heard) {
      lines.push_back(fmt::format("deputy {} is not heard", deputy.id));
    } else if (std::abs(deputy.clock_ahead) > kClockTolerance) {
      lines.push_back(fmt::format("the clock of deputy {} is {:.0f} s {}", deputy.id, std::abs(deputy.clock_ahead),
                                  deputy.clock_ahead > 0 ? "ahead" : "behind"));
    }
  }
  for (const auto& [deputy, names] : sheriff.refused_strangers()) {
    for (const std::string& name : names) {
      lines.push_back(fmt::format("deputy {} refused a stranger's command \"{}\"", deputy, name));
    }
  }
  if (sheriff.yielding()) {
    lines.emplace_back("another sheriff is in command");
  }
  if (width > 0) {
    for (std::string& line : lines) {
      line.resize(std::min(line.size(), width));
    }
  }
  return lines;
}

}  // namespace luminav::launcher
