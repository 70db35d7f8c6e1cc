#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/common/calendar/local_time.hpp"
#include "services/common/configuration/file_versions.hpp"
#include "services/common/tours/jobs_file.hpp"
#include "services/viewer/building/edit_outcome.hpp"
#include "services/viewer/building/tour_order.hpp"

namespace luminav {

/// Carries out orders on the stored tours of a building, as BuildingChanges does on zones and places. Where there is no
/// jobs file the first tour makes one.
class TourChanges {
 public:
  using Order = TourOrder;
  using Contents = std::vector<Tour>;
  static constexpr const char* kStale = "somebody else has changed the tours meanwhile: look at them, and save again";

  /// Reads nothing yet: a jobs file that is damaged keeps nobody from looking at the robot.
  TourChanges(const std::filesystem::path& jobs_file, std::filesystem::path building_file)
      : versions_(jobs_file), building_file_(std::move(building_file)) {}

  [[nodiscard]] const FileVersions& versions() const { return versions_; }
  /// "" where there is no file.
  [[nodiscard]] std::string text() const;
  /// The tours as they are now. Nothing while the file cannot be read.
  [[nodiscard]] std::optional<std::vector<Tour>> read() const;
  /// `utime` [us] dates the version that is kept.
  [[nodiscard]] EditOutcome carry_out(const TourOrder& order, std::int64_t utime) const;
  /// "tours", as JSON, the same at any time of day.
  static std::string members_of(const std::vector<Tour>& tours, const LocalTime& now);

 private:
  [[nodiscard]] EditOutcome change(const TourOrder& order, std::int64_t utime) const;
  [[nodiscard]] EditOutcome undo(const JobsFile& jobs, const Building& building, std::int64_t utime) const;

  FileVersions versions_;
  std::filesystem::path building_file_;  // names the places
};

}  // namespace luminav
