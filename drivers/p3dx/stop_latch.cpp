#include "drivers/p3dx/stop_latch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr std::size_t kRemembered = 128;  // requests; each is repeated for a second at most

}  // namespace

StopLatch::StopLatch(std::filesystem::path folder) {
  if (folder.empty()) {
    return;
  }
  file_ = folder / "stop";
  std::ifstream in(file_);
  int engaged = 0;
  if (in >> engaged >> id_) {
    engaged_ = engaged != 0;
    in.ignore();
    std::getline(in, sender_);
    seen_.emplace_back(sender_, id_);
  }
}

bool StopLatch::request(std::int64_t id, bool engaged, const std::string& sender) {
  const std::pair<std::string, std::int64_t> key{sender, id};
  if (std::find(seen_.begin(), seen_.end(), key) != seen_.end()) {
    return false;
  }
  // Ids are compared within one sender only, since hosts' clocks differ. A stop is obeyed whatever its id.
  const bool outdated = sender == sender_ && id < id_;
  if (!engaged && engaged_ && outdated) {
    return false;
  }
  seen_.push_back(key);
  if (seen_.size() > kRemembered) {
    seen_.pop_front();
  }
  const bool changed = engaged != engaged_;
  engaged_ = engaged;
  id_ = id;
  sender_ = sender;
  kept_ = false;
  return changed;
}

void StopLatch::save() {
  if (kept_ || file_.empty()) {
    return;
  }
  kept_ = true;
  std::error_code error;
  std::filesystem::create_directories(file_.parent_path(), error);
  std::string line = sender_;
  std::replace(line.begin(), line.end(), '\n', ' ');
  try {
    write_whole_file(file_, fmt::format("{} {} {}\n", engaged_ ? 1 : 0, id_, line));
  } catch (const std::runtime_error&) {
    // a full disk must not keep the robot from stopping
  }
}

}  // namespace luminav
