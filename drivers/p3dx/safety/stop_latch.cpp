#include "drivers/p3dx/safety/stop_latch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {

StopLatch::StopLatch(std::filesystem::path folder) {
  if (folder.empty()) {
    return;
  }
  file_ = folder / "stop";
  std::ifstream in(file_);
  int engaged = 0;
  std::int64_t id = 0;
  if (in >> engaged >> id) {
    std::string sender;
    in.ignore();
    std::getline(in, sender);
    requests_ = StopRequests(id, engaged != 0, sender);
  }
}

bool StopLatch::request(std::int64_t id, bool engaged, const std::string& sender) {
  const bool was_engaged = requests_.engaged();
  if (requests_.take(id, engaged, sender) != StopRequests::Verdict::kTaken) {
    return false;
  }
  kept_ = false;
  return engaged != was_engaged;
}

void StopLatch::save() {
  if (kept_ || file_.empty()) {
    return;
  }
  kept_ = true;
  std::error_code error;
  std::filesystem::create_directories(file_.parent_path(), error);
  std::string line = sender();
  std::replace(line.begin(), line.end(), '\n', ' ');
  try {
    write_whole_file(file_, fmt::format("{} {} {}\n", engaged() ? 1 : 0, id(), line), Durability::kRenamed);
  } catch (const std::runtime_error&) {
    // a full disk must not keep the robot from stopping
  }
}

}  // namespace luminav
