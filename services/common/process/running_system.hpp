#pragma once

#include <cstdint>
#include <filesystem>
#include <luminav/node_status_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace luminav {

/// Building and robot that a process was given: what they are called, and sums over the bytes of their files, so that
/// two of one name are told apart. A sum of 0: it needs none.
struct SystemFiles {
  std::string building;
  std::int64_t building_hash = 0;  // of the building's file and map
  std::string robot;
  std::int64_t robot_hash = 0;  // of the robot's file
};

/// Names and sums of files as they are now; "" = none. Throws ConfigurationError or std::runtime_error as reading them
/// does.
SystemFiles identify(const std::filesystem::path& robot_file, const std::filesystem::path& building_file);

/// What a process says of itself.
SystemFiles files_of(const node_status_t& status);

/// "building office, but planner@desk has laboratory", or "" where nothing differs that both need.
std::string difference(const SystemFiles& ours, const node_status_t& theirs);

/// Processes that look on and ask: where they have other files than the system, they are the ones who are wrong.
bool is_onlooker(const std::string& process);

/// Hears in NODE_STATUS which files the others were given. Times in [us] of one clock of this host.
class RunningSystem {
 public:
  void hear(const node_status_t& status, std::int64_t now);

  /// Says how they differ from `ours`: as long as the other one is heard, and a few seconds longer.
  [[nodiscard]] std::string objection(const SystemFiles& ours, std::int64_t now) const;
  /// Says how they differ among each other; "" = they don't.
  [[nodiscard]] std::string disagreement(std::int64_t now) const;
  /// Those of the planner, who takes goals, else of another process that has a building; nothing if there is none.
  [[nodiscard]] std::optional<SystemFiles> files() const;

 private:
  struct Heard {
    node_status_t status;
    std::int64_t when = 0;  // [us]
  };
  std::map<std::string, Heard> processes_;  // by name, host and instance; no onlookers
};

/// Notes where on this machine the files of a system lie, so that who joins it finds them by their sums. Best effort.
void remember_files(const std::filesystem::path& robot_file, const std::filesystem::path& building_file);

/// The file on this machine with that sum: among `candidates`, those remembered, and those that come with the project;
/// "" = none.
std::string find_building(std::int64_t hash, std::vector<std::filesystem::path> candidates);
std::string find_robot(std::int64_t hash, std::vector<std::filesystem::path> candidates);

}  // namespace luminav
