#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

#include "services/common/log/log_file.hpp"

namespace luminav {

/// Appends events to an LCM log as they come, so that a process that is killed loses nothing of them, and a power loss
/// no more than what came since the last `sync`. Only one process may append to a file: others are kept out.
class LogAppender {
 public:
  /// Hands each whole event that the file has to `read`, cuts off what is behind the last one, and goes on from there;
  /// a file that is missing is made. Throws std::runtime_error where it is no log, cannot be written, or is in use.
  LogAppender(const std::filesystem::path& file, const std::function<void(const LogEvent&)>& read);
  ~LogAppender();
  LogAppender(const LogAppender&) = delete;
  LogAppender& operator=(const LogAppender&) = delete;

  /// Throws std::runtime_error when the disk does not take it; what was written of the event is taken back.
  void write(std::int64_t utime, std::string_view channel, const void* data, std::size_t size);
  /// All that was written is on the disk when it returns.
  void sync();

 private:
  void read_whole_events(const std::function<void(const LogEvent&)>& read);
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::int64_t events_ = 0;
  std::uint64_t size_ = 0;  // [bytes] of whole events
};

}  // namespace luminav
