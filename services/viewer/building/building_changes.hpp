#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/configuration/file_versions.hpp"
#include "services/viewer/building/building_order.hpp"

namespace luminav {

/// What became of an order.
struct BuildingOutcome {
  enum class Fate {
    kWaiting,
    kDone,
    kRefused,
    kAsks  // nothing is written until it comes again with `accepts`
  };
  Fate fate = Fate::kWaiting;
  std::string said;                  // why it was refused
  std::vector<std::string> found{};  // wrong by check-building, and not so before
};
std::string_view name_of(BuildingOutcome::Fate fate);

/// Carries out orders on a building's file. Whatever comes out is read, checked and compared with what was meant before
/// it takes the file's place; what the file said before is kept.
class BuildingChanges {
 public:
  /// Reads the file. Throws ConfigurationError or std::runtime_error.
  explicit BuildingChanges(const std::filesystem::path& file) : versions_(file), begun_(read_building(file)) {}

  [[nodiscard]] const FileVersions& versions() const { return versions_; }
  /// The file as it is now. Nothing while it cannot be read, or has other fixtures or another map than it began with:
  /// those are taken over by a start alone.
  [[nodiscard]] std::optional<Building> read() const;
  /// `utime` [us] dates the version that is kept.
  [[nodiscard]] BuildingOutcome carry_out(const BuildingOrder& order, std::int64_t utime) const;

 private:
  [[nodiscard]] BuildingOutcome undo(const Building& building, std::int64_t utime) const;

  FileVersions versions_;
  Building begun_;
};

}  // namespace luminav
