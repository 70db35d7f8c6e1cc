#include "services/common/process/running_system.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <system_error>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/building_watch.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kForgotten = 5'000'000;  // [us] each process says it once a second
constexpr std::size_t kMaxProcesses = 100;

std::int64_t sum_of_robot(const fs::path& file) {
  return FileSum().add(read_whole_file(file)).value();
}

std::int64_t sum_of_building(const fs::path& file, const std::string& map_file) {
  return sum_of_map(map_file).add(read_whole_file(file)).value();
}

std::string name_of(const node_status_t& status) {
  return status.host.empty() ? status.process : status.process + "@" + status.host;
}

std::string differing(const char* what, const std::string& ours, const std::string& who, const std::string& theirs) {
  return ours == theirs ? fmt::format("{} {}, but {} has another file of that name", what, ours, who)
                        : fmt::format("{} {}, but {} has {}", what, ours, who, theirs);
}

fs::path memory_folder() {
  const char* home = std::getenv("HOME");
  return home == nullptr ? fs::path() : fs::path(home) / ".local/state/luminav/files";
}

void remember(std::int64_t hash, const fs::path& file) {
  std::error_code error;
  const fs::path folder = memory_folder();
  const fs::path target = fs::absolute(file, error).lexically_normal();
  fs::create_directories(folder, error);
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (fs::read_symlink(entry.path(), error) == target) {
      fs::remove(entry.path(), error);  // as it was before it was changed
    }
  }
  const fs::path link = folder / fmt::format("{:016x}", hash);
  fs::remove(link, error);
  fs::create_symlink(target, link, error);
}

template <typename SumOf>
std::string find(std::int64_t hash, std::vector<fs::path> candidates, const SumOf& sum_of) {
  std::error_code error;
  if (const fs::path remembered = fs::read_symlink(memory_folder() / fmt::format("{:016x}", hash), error); !error) {
    candidates.push_back(remembered);
  }
  for (const fs::path& file : candidates) {
    try {
      if (!file.empty() && sum_of(file) == hash) {
        return file.string();
      }
    } catch (const std::exception&) {
      // a candidate that cannot be read is none
    }
  }
  return "";
}

}  // namespace

SystemFiles identify(const fs::path& robot_file, const fs::path& building_file) {
  SystemFiles files;
  if (!robot_file.empty()) {
    files.robot = read_robot(robot_file).name;
    files.robot_hash = sum_of_robot(robot_file);
  }
  if (!building_file.empty()) {
    const Building building = read_building(building_file);
    files.building = building.name;
    files.building_hash = sum_of_building(building_file, building.map_file);
  }
  return files;
}

SystemFiles files_of(const node_status_t& status) {
  return {status.building, status.building_hash, status.robot, status.robot_hash};
}

std::string difference(const SystemFiles& ours, const node_status_t& theirs) {
  const auto differ = [](std::int64_t a, std::int64_t b) { return a != 0 && b != 0 && a != b; };
  if (differ(ours.building_hash, theirs.building_hash)) {
    return differing("building", ours.building, name_of(theirs), theirs.building);
  }
  if (differ(ours.robot_hash, theirs.robot_hash)) {
    return differing("robot", ours.robot, name_of(theirs), theirs.robot);
  }
  return "";
}

bool is_onlooker(const std::string& process) {
  return process == "viewer";
}

void RunningSystem::hear(const node_status_t& status, std::int64_t now) {
  if (is_onlooker(status.process) || (status.building_hash == 0 && status.robot_hash == 0)) {
    return;
  }
  std::erase_if(processes_, [&](const auto& entry) { return now - entry.second.when > kForgotten; });
  const std::string key = fmt::format("{} {}", name_of(status), status.instance);  // of one name there may be two
  if (processes_.size() < kMaxProcesses || processes_.contains(key)) {
    processes_[key] = {status, now};
  }
}

std::string RunningSystem::objection(const SystemFiles& ours, std::int64_t now) const {
  for (const auto& [key, heard] : processes_) {
    if (now - heard.when <= kForgotten) {
      if (std::string text = difference(ours, heard.status); !text.empty()) {
        return text;
      }
    }
  }
  return "";
}

std::string RunningSystem::disagreement(std::int64_t now) const {
  for (const auto& [key, heard] : processes_) {
    if (const std::string text = objection(files_of(heard.status), now); !text.empty()) {
      return name_of(heard.status) + " has " + text;
    }
  }
  return "";
}

std::optional<SystemFiles> RunningSystem::files() const {
  std::optional<SystemFiles> found;
  for (const auto& [key, heard] : processes_) {
    if (heard.status.building_hash != 0 && (!found || heard.status.process == "planner")) {
      found = files_of(heard.status);
    }
  }
  return found;
}

void remember_files(const fs::path& robot_file, const fs::path& building_file) {
  const SystemFiles files = identify(robot_file, building_file);
  if (!memory_folder().empty()) {
    remember(files.robot_hash, robot_file);
    remember(files.building_hash, building_file);
  }
}

std::string find_building(std::int64_t hash, std::vector<fs::path> candidates) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(shipped_file("buildings"), error)) {
    candidates.push_back(entry.path() / "building.toml");
  }
  return find(hash, std::move(candidates),
              [](const fs::path& file) { return sum_of_building(file, read_building(file).map_file); });
}

std::string find_robot(std::int64_t hash, std::vector<fs::path> candidates) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(shipped_file("robots"), error)) {
    candidates.push_back(entry.path());
  }
  return find(hash, std::move(candidates), sum_of_robot);
}

}  // namespace luminav
