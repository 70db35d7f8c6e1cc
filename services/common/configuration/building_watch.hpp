#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "services/common/building/building.hpp"

namespace luminav {

/// Tells files apart, and is no secret: FNV-1a, 64 bits.
class FileSum {
 public:
  FileSum& add(std::string_view bytes);
  /// Never 0: that means no file.
  [[nodiscard]] std::int64_t value() const { return value_ == 0 ? 1 : static_cast<std::int64_t>(value_); }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

/// Sum over a building's map as it is read, wherever its picture lies; "" = it has none. Throws as read_map does.
FileSum sum_of_map(const std::string& map_file);

/// The building's file of a process that runs. Zones and places may change meanwhile, and nothing else: fixtures and
/// map are built into too much. So a file is taken over only where it differs in those alone.
class BuildingWatch {
 public:
  /// Reads it. Throws ConfigurationError or std::runtime_error.
  explicit BuildingWatch(std::filesystem::path file);

  [[nodiscard]] const Building& building() const { return building_; }
  /// Of the file's text and the map.
  [[nodiscard]] std::int64_t sum() const { return sum_; }

  /// Somebody has a file with that sum. True if this file has it now, too, and is taken over.
  bool take_over(std::int64_t heard);
  /// True if the file is another one now, and is taken over.
  bool take_over();

 private:
  bool take_over(const std::optional<std::int64_t>& heard);
  [[nodiscard]] std::int64_t sum_of_file();

  std::filesystem::path file_;
  std::pair<std::filesystem::file_time_type, std::uintmax_t> written_{};  // when it was read last, and its size
  std::int64_t sum_of_file_ = 0;                                          // of what it said then
  FileSum map_sum_;
  Building building_;
  std::int64_t sum_ = 0;
};

}  // namespace luminav
