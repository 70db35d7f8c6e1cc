#include "services/launcher/deputy/rotating_log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <system_error>

namespace luminav::launcher {

RotatingLog::~RotatingLog() {
  if (descriptor_ >= 0) {
    close(descriptor_);
  }
}

bool RotatingLog::open() {
  std::error_code ignored;
  std::filesystem::create_directories(file_.parent_path(), ignored);
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  struct stat status {};
  size_ = descriptor_ >= 0 && fstat(descriptor_, &status) == 0 ? status.st_size : 0;
  return descriptor_ >= 0;
}

void RotatingLog::rotate() {
  close(descriptor_);
  descriptor_ = -1;
  std::error_code ignored;
  for (int i = params_.kept; i > 1; --i) {
    std::filesystem::rename(fmt::format("{}.{}", file_.string(), i - 1), fmt::format("{}.{}", file_.string(), i),
                            ignored);
  }
  if (params_.kept > 0) {
    std::filesystem::rename(file_, file_.string() + ".1", ignored);
  } else {
    std::filesystem::remove(file_, ignored);
  }
}

bool RotatingLog::write(std::string_view text) {
  if (descriptor_ >= 0 && size_ + static_cast<std::int64_t>(text.size()) > params_.file_size && size_ > 0) {
    rotate();
  }
  if (descriptor_ < 0 && !open()) {
    return false;
  }
  const ssize_t written = ::write(descriptor_, text.data(), text.size());
  if (written > 0) {
    size_ += written;
  }
  if (written != static_cast<ssize_t>(text.size())) {
    // opened anew with the next text: the folder may be back then
    close(descriptor_);
    descriptor_ = -1;
    return false;
  }
  return true;
}

std::filesystem::path log_file_name(std::string_view command_id) {
  std::string name;
  for (const char c : command_id.substr(0, 100)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                       c == '_' || (c == '.' && !name.empty());
    name += plain ? c : '_';
  }
  return name + ".log";
}

}  // namespace luminav::launcher
