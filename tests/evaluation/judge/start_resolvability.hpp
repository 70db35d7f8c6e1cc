#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "services/localizer/audit/ambiguity_audit.hpp"

namespace luminav {

/// How far a robot must drive at least until the ceiling tells its pose, as scripts/audit has it. A ceiling is read
/// once for all runs below it; any thread may ask.
class StartResolvability {
 public:
  /// Length [m] of the shortest walk on which a start's last twin is refuted, whatever its heading. Infinite: never,
  /// and where there are no fixtures; negative: not known, for a start outside of the places looked at.
  /// Throws ConfigurationError for files that cannot be used.
  [[nodiscard]] double distance(const std::filesystem::path& building_file, const std::filesystem::path& robot_file,
                                const Eigen::Vector2d& start);
  /// Number of ceilings that were read.
  [[nodiscard]] std::size_t audits() const { return audits_.size(); }

 private:
  struct Audit {
    std::once_flag is_made;
    std::optional<AuditFloor> floor;
  };
  std::mutex mutex_;
  std::map<std::string, Audit> audits_;  // by what an audit depends on
};

}  // namespace luminav
