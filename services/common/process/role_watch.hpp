#pragma once

#include <cstdint>
#include <luminav/node_status_t.hpp>
#include <map>
#include <string>

namespace luminav {

/// Notices two processes that play one role for one robot: two controllers forgotten on two machines, or the recorded
/// ones of a log that is played onto the robot's network. A restart is no such case: the old one is not heard again.
class RoleWatch {
 public:
  explicit RoleWatch(std::string robot) : robot_(std::move(robot)) {}

  /// `now` [us] by any clock that does not go back.
  void hear(const node_status_t& status, std::int64_t now);
  /// "two controllers on this network: desk, robot"; "" when each role is played once. Holds for three seconds after
  /// the two were last heard in turn.
  [[nodiscard]] std::string conflict(std::int64_t now) const;
  /// Says it of one role, by the name of its process.
  [[nodiscard]] std::string conflict_of(const std::string& process, std::int64_t now) const;

 private:
  struct Role {
    std::int64_t instance = 0;           // heard last
    std::string host;                    // of it
    std::int64_t previous_instance = 0;  // heard before it, another one
    std::int64_t previous_heard = 0;     // [us]
    std::int64_t heard = 0;              // [us]
    std::int64_t conflict_until = 0;     // [us]
    std::string conflict;
  };
  std::string robot_;
  std::map<std::string, Role> roles_;  // by process, of those that only one may play
};

}  // namespace luminav
