#include "services/common/process/role_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace luminav {
namespace {

constexpr std::int64_t kMemory = 3'000'000;  // [us] three times as long as a process is silent

/// The roles that only one process may play for a robot, and how several are called.
constexpr std::array<std::pair<const char*, const char*>, 10> kRoles = {{{"p3dx", "drivers"},
                                                                         {"create2", "drivers"},
                                                                         {"camera", "cameras"},
                                                                         {"detector", "detectors"},
                                                                         {"localizer", "localizers"},
                                                                         {"mapper", "mappers"},
                                                                         {"planner", "planners"},
                                                                         {"controller", "controllers"},
                                                                         {"jobs", "job services"},
                                                                         {"simulator", "simulators"}}};

const char* name_of_several(const std::string& process) {
  for (const auto& [role, several] : kRoles) {
    if (process == role) {
      return several;
    }
  }
  return nullptr;
}

}  // namespace

void RoleWatch::hear(const node_status_t& status, std::int64_t now) {
  const char* several = name_of_several(status.process);
  if (several == nullptr || status.robot != robot_) {
    return;
  }
  Role& role = roles_[status.process];
  if (status.instance != role.instance) {
    const bool heard_again = status.instance == role.previous_instance && now - role.previous_heard < kMemory;
    if (heard_again) {
      const auto [first, second] = std::minmax(role.host, status.host);
      role.conflict = first == second ? fmt::format("two {} on this network, both on {}", several, first)
                                      : fmt::format("two {} on this network: {}, {}", several, first, second);
      role.conflict_until = now + kMemory;
    }
    role.previous_instance = std::exchange(role.instance, status.instance);
    role.host = status.host.substr(0, 64);
    role.previous_heard = role.heard;
  }
  role.heard = now;
}

std::string RoleWatch::conflict(std::int64_t now) const {
  for (const auto& [process, role] : roles_) {
    if (now < role.conflict_until) {
      return role.conflict;
    }
  }
  return "";
}

std::string RoleWatch::conflict_of(const std::string& process, std::int64_t now) const {
  const auto role = roles_.find(process);
  return role != roles_.end() && now < role->second.conflict_until ? role->second.conflict : "";
}

}  // namespace luminav
