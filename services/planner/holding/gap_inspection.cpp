#include "services/planner/holding/gap_inspection.hpp"

#include <limits>

namespace luminav {
namespace {

// Evidence below is a gap: first much of it, then what is surer, at last all but the surest.
constexpr double kOccupiedLogOdds[] = {1.8, 2.4, 3.2};
constexpr double kGapRadius = 0.25;    // [m] round a gap that is not looked at twice
constexpr std::size_t kMaxLooks = 12;  // for a stop, and as many again from elsewhere
constexpr double kDetourRatio = 1.2;   // a detour this much longer than through the gap is not taken before,
constexpr double kDetourLength = 1.0;  // [m] and this much beside: it leads through what nobody has seen

double worth(double through) {
  return kDetourRatio * through + kDetourLength;
}

}  // namespace

void GapInspection::reset() {
  looked_at_.clear();
  has_looked_twice_ = false;
}

std::optional<Gap> GapInspection::choose(const RouteMap& map, const RouteRequest& request, const Route& route) {
  const bool is_found = route.outcome == RouteOutcome::kFound;
  const bool may_exist =
      is_found || route.outcome == RouteOutcome::kUnreachable || route.outcome == RouteOutcome::kGoalBlocked;
  // no sonar draws what is only suspected: it is dropped before anything is looked at
  const bool is_suspected = !is_found && !map.suspects().empty();
  if (!map.is_drawn_by_robot() || !may_exist || is_suspected || looked_at_.size() >= kMaxLooks) {
    return std::nullopt;
  }
  const double length = is_found ? map.length_with_unknown(route.points) : std::numeric_limits<double>::infinity();
  if (length < worth((request.goal - request.start).norm())) {
    return std::nullopt;
  }
  std::optional<Gap> gap = best_gap(map, request, length);
  if (!gap && !is_found && !has_looked_twice_ && !looked_at_.empty()) {
    has_looked_twice_ = true;  // from elsewhere they may look otherwise
    looked_at_.clear();
    gap = best_gap(map, request, length);
  }
  if (gap) {
    looked_at_.push_back({gap->path[gap->blocked_at], kGapRadius});
  }
  return gap;
}

std::optional<Gap> GapInspection::best_gap(const RouteMap& map, const RouteRequest& request, double length) {
  std::vector<SuspectedObstacle> obstacles = looked_at_;
  for (const SuspectedObstacle& suspect : map.suspects().all()) {
    obstacles.push_back(suspect);
  }
  std::optional<Gap> best;
  for (const double occupied : kOccupiedLogOdds) {
    const Route detour = map.plan_by_sure_evidence(request, occupied, obstacles);
    if (detour.outcome != RouteOutcome::kFound) {
      continue;
    }
    // of two, the one with less doubt if about as long
    const double through = worth(map.length_with_unknown(detour.points));
    const std::optional<std::size_t> blocked = map.first_blocked(detour.points);
    if (blocked && through < length) {
      best = {detour.points, *blocked};
      length = limit_ = through;
    }
  }
  return best;
}

}  // namespace luminav
