#include "services/localizer/audit/ambiguity_audit.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <thread>

namespace luminav {
namespace {

constexpr double kNever = ResolvingWalk::kNever;
constexpr double kNeverDistance = 50.0;  // [m] that a start which never resolves counts in means
constexpr double kBlock = 3.0;           // [m] of floor whose places follow each other
constexpr std::size_t kParts =
    16;  // of the starts: each remembers what it found, whatever machine runs how many at once
constexpr std::size_t kMaxForChanges = 100;  // starts that a change is tried on
constexpr std::size_t kMaxCandidates = 12;   // fixtures whose change is tried: those below which most is driven

double counted(const AuditStart& start) {
  return std::min(start.distance, kNeverDistance);
}

/// The fixtures in view where most is driven.
std::vector<int> costly_fixtures(const AuditFloor& floor, const std::vector<AuditStart>& starts) {
  std::map<int, double> cost;
  for (const AuditStart& start : starts) {
    for (const int index : floor.in_view(start.place)) {
      cost[index] += counted(start);
    }
  }
  std::vector<int> fixtures;
  std::transform(cost.begin(), cost.end(), std::back_inserter(fixtures), [](const auto& each) { return each.first; });
  std::stable_sort(fixtures.begin(), fixtures.end(), [&](int a, int b) { return cost[a] > cost[b]; });
  fixtures.resize(std::min(kMaxCandidates, fixtures.size()));
  return fixtures;
}

}  // namespace

StartAudit::StartAudit(const AuditFloor& floor, int changed)
    : floor_(floor), changed_(changed), walk_(floor.ground()), blind_(floor.ground()) {}

AuditStart StartAudit::in_sight(std::int32_t place, double enough) {
  const std::vector<AliasMotion> aliases = floor_.aliases(place, changed_);
  const ResolvingWalk::Result walk = walk_.find(
      place, aliases.size(),
      [&](std::size_t alias, std::int32_t at) { return floor_.is_alias(aliases[alias], at, changed_); }, enough);
  return {place, aliases.size(), walk.length};
}

AuditStart StartAudit::at(std::int32_t place) {
  if (!floor_.is_blind(place)) {
    return in_sight(place, kNever);
  }
  AuditStart best{place, 0, kNever};
  std::set<std::vector<int>> known;
  blind_.begin({place});
  for (auto next = blind_.next(); next && blind_.distance(*next) < best.distance; next = blind_.next()) {
    if (floor_.is_blind(*next)) {
      blind_.pass(*next);
      continue;
    }
    if (!known.insert(floor_.in_view(*next)).second) {
      continue;  // the place where the same came into view is nearer
    }
    const AuditStart from = in_sight(*next, best.distance - blind_.distance(*next));
    best.distance = std::min(best.distance, blind_.distance(*next) + from.distance);
  }
  return best;
}

std::vector<std::int32_t> spread_starts(const AuditFloor& floor, std::size_t max) {
  const std::vector<Eigen::Vector2d>& points = floor.ground().points;
  std::vector<std::int32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto block = [&](std::int32_t place) {
    const Eigen::Vector2d& point = points[static_cast<std::size_t>(place)];
    return std::pair(std::floor(point.y() / kBlock), std::floor(point.x() / kBlock));
  };
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return block(a) < block(b); });
  const std::size_t count = std::min(max, order.size());
  std::vector<std::int32_t> starts;
  std::mt19937 random(1);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = i * order.size() / count;
    const std::size_t last = (i + 1) * order.size() / count;
    starts.push_back(order[first + random() % (last - first)]);
  }
  return starts;
}

std::vector<AuditStart> audit_starts(const AuditFloor& floor, std::span<const std::int32_t> places,
                                     const std::function<void(std::size_t done)>& said, int changed) {
  std::vector<AuditStart> starts(places.size());
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  std::vector<std::future<void>> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    threads.push_back(std::async(std::launch::async, [&] {
      for (std::size_t part = next++; part < kParts; part = next++) {
        StartAudit audit(floor, changed);
        for (std::size_t k = part * places.size() / kParts; k < (part + 1) * places.size() / kParts; ++k) {
          starts[k] = audit.at(places[k]);
          if (said) {
            said(++done);
          }
        }
      }
    }));
  }
  for (std::future<void>& thread : threads) {
    thread.get();
  }
  return starts;
}

double distance_quantile(const std::vector<AuditStart>& starts, double share) {
  std::vector<double> sorted;
  std::transform(starts.begin(), starts.end(), std::back_inserter(sorted),
                 [](const AuditStart& start) { return start.distance; });
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

double mean_distance(const std::vector<AuditStart>& starts) {
  double sum = 0.0;
  for (const AuditStart& start : starts) {
    sum += counted(start);
  }
  return sum / std::max(1.0, static_cast<double>(starts.size()));
}

double never_share(const std::vector<AuditStart>& starts) {
  const auto never =
      std::count_if(starts.begin(), starts.end(), [](const AuditStart& start) { return std::isinf(start.distance); });
  return static_cast<double>(never) / std::max(1.0, static_cast<double>(starts.size()));
}

std::vector<AuditChange> best_changes(const AuditFloor& floor, const std::vector<AuditStart>& starts, std::size_t max) {
  std::vector<AuditChange> changes;
  if (mean_distance(starts) < AuditFloor::kCell) {
    return changes;
  }
  std::vector<std::int32_t> places;
  for (std::size_t i = 0; i < std::min(kMaxForChanges, starts.size()); ++i) {
    places.push_back(starts[i * starts.size() / std::min(kMaxForChanges, starts.size())].place);
  }
  const std::vector<AuditStart> before = audit_starts(floor, places, nullptr);
  for (const int fixture : costly_fixtures(floor, starts)) {
    const std::vector<AuditStart> after = audit_starts(floor, places, nullptr, fixture);
    changes.push_back({floor.fixture(fixture).id, mean_distance(after) - mean_distance(before),
                       never_share(after) - never_share(before)});
  }
  std::stable_sort(changes.begin(), changes.end(),
                   [](const AuditChange& a, const AuditChange& b) { return a.mean_change < b.mean_change; });
  changes.resize(std::min(max, changes.size()));
  return changes;
}

}  // namespace luminav
