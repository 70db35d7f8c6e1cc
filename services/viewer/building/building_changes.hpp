#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "services/common/building/building.hpp"
#include "services/common/calendar/local_time.hpp"
#include "services/common/configuration/file_versions.hpp"
#include "services/viewer/building/building_order.hpp"
#include "services/viewer/building/edit_outcome.hpp"

namespace luminav {

/// Carries out orders on a building's file. Whatever comes out is read, checked and compared with what was meant before
/// it takes the file's place; what the file said before is kept.
class BuildingChanges {
 public:
  using Order = BuildingOrder;
  using Contents = Building;
  static constexpr const char* kStale = "somebody else has changed the building meanwhile: look at it, and save again";

  /// Reads the file. Throws ConfigurationError or std::runtime_error. `jobs_file` names places that must stay.
  BuildingChanges(const std::filesystem::path& file, std::filesystem::path jobs_file)
      : versions_(file), jobs_file_(std::move(jobs_file)), begun_(read_building(file)) {}

  [[nodiscard]] const FileVersions& versions() const { return versions_; }
  [[nodiscard]] std::string text() const { return versions_.read(); }
  /// The file as it is now. Nothing while it cannot be read, or has other fixtures or another map than it began with:
  /// those are taken over by a start alone.
  [[nodiscard]] std::optional<Building> read() const;
  /// `utime` [us] dates the version that is kept.
  [[nodiscard]] EditOutcome carry_out(const BuildingOrder& order, std::int64_t utime) const;

  /// "zones", with those that are in force, and "places", as JSON.
  static std::string members_of(const Building& building, const LocalTime& now);

 private:
  [[nodiscard]] EditOutcome undo(const Building& building, std::int64_t utime) const;

  FileVersions versions_;
  std::filesystem::path jobs_file_;
  Building begun_;
};

}  // namespace luminav
