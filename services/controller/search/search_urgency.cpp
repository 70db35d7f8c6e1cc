#include "services/controller/search/search_urgency.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "services/controller/search/path_lattice.hpp"

namespace luminav {
namespace {

/// Ways [m] after which each pose is told from each other one as the truth, row by row.
std::vector<double> telling_distances(const std::vector<PossiblePose>& poses, const Eigen::Vector2d& began_at,
                                      const CeilingForecast& forecast, const SearchMap& map, const ViewRules& rules,
                                      const std::function<double(const Eigen::Vector2d&)>& price,
                                      const SearchUrgencyParams& params) {
  const std::size_t count = poses.size();
  std::vector<double> distances(count * count, params.reach);
  std::vector<std::optional<PredictedView>> views(count);
  PathLattice lattice(began_at, params.reach, params.step);
  for (auto visit = lattice.next(); visit && visit->distance < params.reach; visit = lattice.next()) {
    const Eigen::Vector2d place = lattice.place_of(visit->node);
    const bool is_known_floor = map.ground_at(place) == Ground::kFree;
    std::transform(poses.begin(), poses.end(), views.begin(),
                   [&](const PossiblePose& pose) { return predict(forecast, pose, place, is_known_floor, rules); });
    for (std::size_t truth = 0; truth < count; ++truth) {
      if (!views[truth] || views[truth]->is_wall) {
        continue;
      }
      for (std::size_t rival = 0; rival < count; ++rival) {
        double& distance = distances[truth * count + rival];
        if (rival != truth && distance > visit->distance && views[rival] &&
            !look_alike(*views[truth], *views[rival], rules)) {
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
                 const SearchMap& map, const ViewRules& rules,
                 const std::function<double(const Eigen::Vector2d&)>& price, const SearchUrgencyParams& params) {
  if (poses.size() < 2) {
    return;
  }
  const std::vector<double> distances = telling_distances(poses, began_at, forecast, map, rules, price, params);
  std::vector<std::pair<double, double>> distance_and_weight;  // of its rivals, the nearest first
  double mean = 0.0;
  double chance = 0.0;
  for (std::size_t truth = 0; truth < poses.size(); ++truth) {
    distance_and_weight.clear();
    double wanted = 0.0;
    for (std::size_t rival = 0; rival < poses.size(); ++rival) {
      if (rival != truth) {
        distance_and_weight.emplace_back(distances[truth * poses.size() + rival], poses[rival].weight);
        wanted += params.share * poses[rival].weight;
      }
    }
    std::sort(distance_and_weight.begin(), distance_and_weight.end());
    double distance = params.reach;
    for (const auto& [each, weight] : distance_and_weight) {
      wanted -= weight;
      if (wanted <= 0.0) {
        distance = each;
        break;
      }
    }
    PossiblePose& pose = poses[truth];
    pose.urgency = std::pow(params.min + distance, -params.power);
    mean += pose.urgency * pose.chance;
    chance += pose.chance;
  }
  for (PossiblePose& pose : poses) {
    pose.urgency *= mean > 0.0 ? chance / mean : 0.0;
  }
}

}  // namespace luminav
