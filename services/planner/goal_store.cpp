#include "services/planner/goal_store.hpp"

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace luminav {

GoalStore::GoalStore(const std::filesystem::path& folder) : file_(folder.empty() ? folder : folder / "goal.bin") {}

void GoalStore::keep(const StoredGoal& stored) const {
  if (file_.empty()) {
    return;
  }
  std::vector<char> bytes(sizeof stored.pose_index + static_cast<std::size_t>(stored.goal.getEncodedSize()));
  std::memcpy(bytes.data(), &stored.pose_index, sizeof stored.pose_index);
  if (stored.goal.encode(bytes.data() + sizeof stored.pose_index, 0, stored.goal.getEncodedSize()) < 0) {
    throw std::runtime_error("the goal cannot be encoded");
  }
  std::filesystem::create_directories(file_.parent_path());
  const std::filesystem::path temporary = file_.string() + ".tmp";
  {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) {
      throw std::runtime_error(temporary.string() + ": cannot be written");
    }
  }
  std::filesystem::rename(temporary, file_);
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
