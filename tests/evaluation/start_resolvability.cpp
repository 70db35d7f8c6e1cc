#include "tests/evaluation/start_resolvability.hpp"

#include <algorithm>

#include "services/common/building/map_file.hpp"
#include "services/localizer/ambiguity_audit.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMostFixtures = 1000;  // beyond, the audit takes longer than the run
constexpr double kNearEnough = 0.75;         // [m] from the start to the next place: it may stand nearer to a wall

}  // namespace

double resolvable_way(const Building& building, const CameraDescription& camera, const Eigen::Vector2d& start) {
  if (building.fixtures.empty() || building.fixtures.size() > kMostFixtures) {
    return -1.0;
  }
  const PriorMap walls = building.map_file.empty() ? PriorMap{} : read_map(building.map_file);
  const AmbiguityAudit audit(building, walls, camera, AuditParams{});
  const auto distance_to = [&](const AuditPlace& place) { return (place.point - start).norm(); };
  const auto nearest =
      std::min_element(audit.places().begin(), audit.places().end(),
                       [&](const AuditPlace& a, const AuditPlace& b) { return distance_to(a) < distance_to(b); });
  return nearest == audit.places().end() || distance_to(*nearest) > kNearEnough ? -1.0 : nearest->way;
}

}  // namespace luminav
