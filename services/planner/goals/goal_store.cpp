#include "services/planner/goals/goal_store.hpp"

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {

GoalStore::GoalStore(const std::filesystem::path& folder) : file_(folder.empty() ? folder : folder / "goal.bin") {}

void GoalStore::keep(const StoredGoal& stored) const {
  if (file_.empty()) {
    return;
  }
  std::string bytes(sizeof stored.pose_index + static_cast<std::size_t>(stored.goal.getEncodedSize()), '\0');
  std::memcpy(bytes.data(), &stored.pose_index, sizeof stored.pose_index);
  if (stored.goal.encode(bytes.data() + sizeof stored.pose_index, 0, stored.goal.getEncodedSize()) < 0) {
    throw std::runtime_error("the goal cannot be encoded");
  }
  std::filesystem::create_directories(file_.parent_path());
  write_whole_file(file_, bytes, Durability::kRenamed);
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
  const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  StoredGoal stored;
  if (bytes.size() <= sizeof stored.pose_index) {
    return std::nullopt;
  }
  std::memcpy(&stored.pose_index, bytes.data(), sizeof stored.pose_index);
  const auto size = static_cast<int>(bytes.size() - sizeof stored.pose_index);
  try {
    if (stored.goal.decode(bytes.data() + sizeof stored.pose_index, 0, size) < 0) {
      return std::nullopt;
    }
  } catch (const std::exception&) {  // LCM's decoding throws on damaged counts
    return std::nullopt;
  }
  return stored;
}

}  // namespace luminav
