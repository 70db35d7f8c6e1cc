#include "services/controller/search/search_urgency.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "services/controller/search/path_lattice.hpp"

namespace luminav {
namespace {

constexpr double kReach = 8.0;  // [m] from where the search began, paths are looked at
constexpr double kStep = 0.4;   // [m] between places
constexpr double kShare = 0.8;  // of its rivals' weight that a pose must be told from
constexpr double kMin = 1.0;    // [m] added to each distance
constexpr double kPower = 2.0;  // with which the urgency falls with the distance

/// Distances [m] after which each pose is told from each other one as the truth, row by row.
std::vector<double> telling_distances(const std::vector<PossiblePose>& poses, const Eigen::Vector2d& began_at,
                                      const CeilingForecast& forecast, const SearchMap& map,
                                      const std::function<double(const Eigen::Vector2d&)>& price) {
  const std::size_t count = poses.size();
  std::vector<double> distances(count * count, kReach);
  std::vector<std::optional<PredictedView>> views(count);
  PathLattice lattice(began_at, kReach, kStep);
  for (auto visit = lattice.next(); visit && visit->distance < kReach; visit = lattice.next()) {
    const Eigen::Vector2d place = lattice.place_of(visit->node);
    const bool is_known_floor = map.ground_at(place) == Ground::kFree;
    std::transform(poses.begin(), poses.end(), views.begin(),
                   [&](const PossiblePose& pose) { return predict(forecast, pose, place, is_known_floor); });
    for (std::size_t truth = 0; truth < count; ++truth) {
      if (!views[truth] || views[truth]->is_wall) {
        continue;
      }
      for (std::size_t rival = 0; rival < count; ++rival) {
        double& distance = distances[truth * count + rival];
        if (rival != truth && distance > visit->distance && views[rival] && !look_alike(*views[truth], *views[rival])) {
          distance = visit->distance;
        }
      }
    }
    lattice.expand(*visit, price);
  }
  return distances;
}

}  // namespace

void set_urgency(std::vector<PossiblePose>& poses, const Eigen::Vector2d& began_at, const CeilingForecast& forecast,
                 const SearchMap& map, const std::function<double(const Eigen::Vector2d&)>& price) {
  if (poses.size() < 2) {
    return;
  }
  const std::vector<double> distances = telling_distances(poses, began_at, forecast, map, price);
  std::vector<std::pair<double, double>> distance_and_weight;  // of its rivals, the nearest first
  double mean = 0.0;
  double chance = 0.0;
  for (std::size_t truth = 0; truth < poses.size(); ++truth) {
    distance_and_weight.clear();
    double wanted = 0.0;
    for (std::size_t rival = 0; rival < poses.size(); ++rival) {
      if (rival != truth) {
        distance_and_weight.emplace_back(distances[truth * poses.size() + rival], poses[rival].weight);
        wanted += kShare * poses[rival].weight;
      }
    }
    std::sort(distance_and_weight.begin(), distance_and_weight.end());
    double distance = kReach;
    for (const auto& [each, weight] : distance_and_weight) {
      wanted -= weight;
      if (wanted <= 0.0) {
        distance = each;
        break;
      }
    }
    PossiblePose& pose = poses[truth];
    pose.urgency = std::pow(kMin + distance, -kPower);
    mean += pose.urgency * pose.chance;
    chance += pose.chance;
  }
  for (PossiblePose& pose : poses) {
    pose.urgency *= mean > 0.0 ? chance / mean : 0.0;
  }
}

}  // namespace luminav
