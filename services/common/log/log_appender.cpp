#include "services/common/log/log_appender.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {

LogAppender::LogAppender(const std::filesystem::path& file, const std::function<void(const LogEvent&)>& read)
    : file_(file) {
  if (file_.has_parent_path()) {
    make_folders(file_.parent_path());
  }
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    fail();
  }
  try {
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      throw std::runtime_error(fmt::format("{}: another process writes it", file_.string()));
    }
    read_whole_events(read);
    if (ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) {
      fail();
    }
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

LogAppender::~LogAppender() {
  fdatasync(descriptor_);
  close(descriptor_);
}

void LogAppender::read_whole_events(const std::function<void(const LogEvent&)>& read) {
  if (std::filesystem::file_size(file_) == 0) {
    return;
  }
  LogReader reader(file_.string());
  for (LogEvent event; reader.next(event);) {
    read(event);
    ++events_;
  }
  size_ = reader.position();
}

void LogAppender::write(std::int64_t utime, std::string_view channel, const void* data, std::size_t size) {
  std::string event = log_event_head(events_, utime, channel, size);
  event.append(static_cast<const char*>(data), size);
  for (std::size_t written = 0; written < event.size();) {
    const ssize_t count = ::write(descriptor_, event.data() + written, event.size() - written);
    if (count < 0 && errno != EINTR) {
      const int cause = errno;
      // where this fails too, what is cut is cut off when the log is read
      [[maybe_unused]] const int ignored = ftruncate(descriptor_, static_cast<off_t>(size_));
      errno = cause;
      fail();
    }
    written += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  size_ += event.size();
  ++events_;
}

void LogAppender::sync() {
  if (fdatasync(descriptor_) != 0) {
    fail();
  }
}

void LogAppender::fail() const {
  throw std::runtime_error(
      fmt::format("{}: cannot be written: {}", file_.string(), std::generic_category().message(errno)));
}

}  // namespace luminav
