#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace luminav {

/// Names a text: two versions of a file differ in it.
std::string version_of(std::string_view text);

/// A file that people and programs change and, beside it, what it said before: building-before-2026-01-31-153000.toml.
class FileVersions {
 public:
  explicit FileVersions(std::filesystem::path file) : file_(std::move(file)) {}

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// When it was written last, and its size: another one is another file. Nothing where there is none.
  [[nodiscard]] std::optional<std::pair<std::filesystem::file_time_type, std::uintmax_t>> stamp() const;
  /// Throws std::runtime_error when it cannot be read.
  [[nodiscard]] std::string read() const;
  /// Keeps what it says under a name with the date of `utime` [us], which it returns, and writes the text. Throws
  /// std::runtime_error; then the file is what it was.
  std::filesystem::path replace(const std::string& text, std::int64_t utime) const;

  /// The newest file that was kept; empty = none.
  [[nodiscard]] std::filesystem::path newest_before() const;
  /// Puts that one in the place of the file, which is kept as building-undone-DATE.toml. Throws std::runtime_error.
  void undo(std::int64_t utime) const;

  /// While it lives no other process of this machine that asks for one changes a file in the folder: they wait for each
  /// other.
  class Lock {
   public:
    /// Throws std::runtime_error where the folder cannot be locked.
    explicit Lock(const std::filesystem::path& file);
    ~Lock();
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    int descriptor_;
  };

  /// A file in the same folder, so that what is named in it is found; gone with this object.
  class Draft {
   public:
    Draft(const std::filesystem::path& file, const std::string& text);
    ~Draft();
    Draft(const Draft&) = delete;
    Draft& operator=(const Draft&) = delete;
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

   private:
    std::filesystem::path file_;
  };

 private:
  /// A name that nothing has: building-WORD-DATE.toml.
  [[nodiscard]] std::filesystem::path new_name(std::string_view word, std::int64_t utime) const;

  std::filesystem::path file_;
};

}  // namespace luminav
