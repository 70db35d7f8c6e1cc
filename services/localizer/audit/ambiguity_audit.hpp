#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "services/localizer/audit/audit_floor.hpp"
#include "services/localizer/audit/resolving_walk.hpp"

namespace luminav {

/// A place where the robot may be switched on, and what it takes to tell the pose from there.
struct AuditStart {
  std::int32_t place = 0;
  std::size_t aliases = 0;  // other poses that look the same, half turns included; 0 where nothing is seen
  double distance = 0.0;    // [m] that somebody who knows the pose drives to have it proved; infinite: never
};

/// Finds the shortest drives that prove the pose. Robot and alias drive side by side until one of them sees what the
/// other does not, or the alias stands in a wall.
class StartAudit {
 public:
  /// The floor must outlive it. `changed`: a fixture that became of another kind, -1 = none.
  explicit StartAudit(const AuditFloor& floor, int changed = -1);
  /// Who sees nothing drives to where something is seen, and goes on from there.
  [[nodiscard]] AuditStart at(std::int32_t place);

 private:
  [[nodiscard]] AuditStart in_sight(std::int32_t place, double enough);

  const AuditFloor& floor_;
  int changed_;
  ResolvingWalk walk_;
  GroundSearch blind_;
};

/// At most so many places, spread evenly over the floor and by chance within their share of it; the same each time.
[[nodiscard]] std::vector<std::int32_t> spread_starts(const AuditFloor& floor, std::size_t max);

/// All starts, in the order of the places, by as many threads as the machine has cores. `said` hears how many are done,
/// from any thread.
[[nodiscard]] std::vector<AuditStart> audit_starts(const AuditFloor& floor, std::span<const std::int32_t> places,
                                                   const std::function<void(std::size_t done)>& said = nullptr,
                                                   int changed = -1);

/// Distance [m] that a share of the starts needs at most; infinite when more than the rest never resolve.
[[nodiscard]] double distance_quantile(const std::vector<AuditStart>& starts, double share);
/// Mean distance [m], in which a start that never resolves counts as 50 m.
[[nodiscard]] double mean_distance(const std::vector<AuditStart>& starts);
/// Share of the starts that never resolve.
[[nodiscard]] double never_share(const std::vector<AuditStart>& starts);

/// What one change would do.
struct AuditChange {
  int fixture = 0;            // id of the fixture to be made another kind, or beside which a vent would be seen
  double mean_change = 0.0;   // [m] of the mean distance
  double never_change = 0.0;  // of the share of starts that never resolve
};

/// The single changes that help most, best first, tried on a part of the starts; empty when nothing needs help.
[[nodiscard]] std::vector<AuditChange> best_changes(const AuditFloor& floor, const std::vector<AuditStart>& starts,
                                                    std::size_t max);

}  // namespace luminav
