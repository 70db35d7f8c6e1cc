#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace luminav::launcher {

struct RotatingLogParams {
  std::int64_t file_size = 4'000'000;  // [bytes] then a new file begins
  int kept = 3;                        // older files kept as NAME.1 (newest) ... NAME.3
};

/// The log file of one process. A disk that is full or a folder that went away costs text, never the process.
class RotatingLog {
 public:
  RotatingLog(std::filesystem::path file, const RotatingLogParams& params) : file_(std::move(file)), params_(params) {}
  ~RotatingLog();
  RotatingLog(const RotatingLog&) = delete;
  RotatingLog& operator=(const RotatingLog&) = delete;

  /// False when not all of the text could be written.
  bool write(std::string_view text);
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  bool open();
  void rotate();

  std::filesystem::path file_;
  RotatingLogParams params_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;  // [bytes]
};

/// File name for a command: everything that has a meaning to the file system becomes '_'.
std::filesystem::path log_file_name(std::string_view command_id);

}  // namespace luminav::launcher
