#include "services/planner/goals/goal_store.hpp"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "services/common/configuration/whole_file.hpp"
#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr const char* kFormat = "luminav goal 2";
constexpr double kFresh = 120.0;  // [s] since the goal was kept last: its people still stand beside the robot

std::string say_age(double seconds) {
  return seconds < 5400.0     ? fmt::format("{:.0f} min", seconds / 60.0)
         : seconds < 129600.0 ? fmt::format("{:.0f} h", seconds / 3600.0)
                              : fmt::format("{:.0f} days", seconds / 86400.0);
}

/// Lines before the message.
std::string heading_of(const StoredGoal& stored) {
  return fmt::format("{}\n{}\n{}\n{} {} {}\n", kFormat, stored.kept.boot, stored.kept.building, stored.kept.utime,
                     stored.pose_index, stored.asks ? 1 : 0);
}

}  // namespace

std::string objection_to_resuming(const StoredGoal& stored, const GoalCircumstances& now) {
  if (stored.kept.building != now.building) {
    return fmt::format("it is of building \"{}\", this is \"{}\"", stored.kept.building, now.building);
  }
  if (stored.kept.boot.empty() || stored.kept.boot != now.boot) {
    return "the machine was started anew since";
  }
  const double age = seconds_between(stored.kept.utime, now.utime);
  if (age < 0.0 || age > kFresh) {
    return age < 0.0 ? "the robot's clock went back since" : fmt::format("that was {} ago", say_age(age));
  }
  return stored.asks ? "it was paused, or the planner ended in order" : "";
}

GoalStore::GoalStore(const std::filesystem::path& folder) : file_(folder.empty() ? folder : folder / "goal.bin") {}

void GoalStore::keep(const StoredGoal& stored) const {
  if (file_.empty()) {
    return;
  }
  std::vector<char> bytes(static_cast<std::size_t>(stored.goal.getEncodedSize()));
  if (stored.goal.encode(bytes.data(), 0, stored.goal.getEncodedSize()) < 0) {
    throw std::runtime_error("the goal cannot be encoded");
  }
  std::filesystem::create_directories(file_.parent_path());
  write_whole_file(file_, heading_of(stored) + std::string(bytes.begin(), bytes.end()), Durability::kRenamed);
}

void GoalStore::forget() const {
  if (!file_.empty()) {
    std::error_code ignored;  // what is not there need not be removed
    std::filesystem::remove(file_, ignored);
  }
}

std::optional<StoredGoal> GoalStore::recall() const {
  if (file_.empty()) {
    return std::nullopt;
  }
  std::ifstream in(file_, std::ios::binary);
  StoredGoal stored;
  std::string format;
  std::getline(in, format);
  std::getline(in, stored.kept.boot);
  std::getline(in, stored.kept.building);
  in >> stored.kept.utime >> stored.pose_index >> stored.asks;
  if (format != kFormat || !in || in.get() != '\n') {
    return std::nullopt;
  }
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  try {
    if (stored.goal.decode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) {
      return std::nullopt;
    }
  } catch (const std::exception&) {  // LCM's decoding throws on damaged counts
    return std::nullopt;
  }
  return stored;
}

}  // namespace luminav
