#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/controller/search/ceiling_forecast.hpp"
#include "services/controller/search/predicted_view.hpp"
#include "services/controller/search/search_map.hpp"
#include "services/controller/search/search_price.hpp"
#include "services/controller/search/search_urgency.hpp"

namespace luminav {

/// Where the robot may be: one of the localizer's HYPOTHESES.
struct PoseAlternative {
  Pose2 world_from_odom;
  double weight = 0.0;
};

/// Where a search stands [m, odom].
struct SearchPlaces {
  Eigen::Vector2d robot;
  Eigen::Vector2d began_at;
  std::optional<Eigen::Vector2d> heading_for;  // where the last path led to
};

/// Finds the place to drive to when several poses are possible: where their predictions differ most for the
/// shortest path.
class Disambiguation {
 public:
  explicit Disambiguation(CeilingForecast forecast) : forecast_(std::move(forecast)) {}

  /// Returns the path [m, odom] from the robot to the place that tells most; nothing if none within reach does.
  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> path(const SearchPlaces& places,
                                                                 std::span<const PoseAlternative> alternatives,
                                                                 const SearchMap& map) const;

 private:
  /// Poses that predict the same of a place.
  struct View {
    PredictedView predicted;
    double weight = 0.0;  // sums of theirs, see PossiblePose
    double chance = 0.0;  // likewise, by their urgency
  };
  [[nodiscard]] std::vector<PossiblePose> chosen(std::span<const PoseAlternative> alternatives) const;
  [[nodiscard]] double price(const Eigen::Vector2d& place, const Eigen::Vector2d& started_at,
                             std::span<const PossiblePose> poses, const SearchMap& map) const;
  [[nodiscard]] double worth(const Eigen::Vector2d& place, std::span<const PossiblePose> poses, const SearchMap& map,
                             std::vector<View>& views) const;

  CeilingForecast forecast_;
};

}  // namespace luminav
