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

struct DisambiguationParams {
  double reach = 10.0;         // [m] around the robot places are looked at
  double step = 0.2;           // [m] between them
  int max = 48;                // alternatives looked at
  double flattening = 0.5;     // power of the weights: all rivals have to go, the unlikely ones too
  double seen_and_not = 0.55;  // what it tells when a fixture is seen that the rival has not, 1 = everything
  double missed = 0.25;        // likewise one that the rival has and that is not there
  double wall = 1.0;           // likewise to drive where the rival has a wall
  double any_fixture = 0.05;   // worth of a fixture that all have and none saw yet
  double min_worth = 0.02;     // less is not worth a way
  double head_start = 1.5;     // [m] added to each way, so that a little worth close by does not win
  double faithfulness = 2.0;   // what another place must be better than where it is heading
  double room_at_start = 0.4;  // [m] around it there is room, whatever the sonars heard
  ViewRules views;
  SearchPriceParams price;
  SearchUrgencyParams urgency;
};

/// Where a search stands [m, odom].
struct SearchPlaces {
  Eigen::Vector2d robot;
  Eigen::Vector2d began_at;
  std::optional<Eigen::Vector2d> heading_for;  // where the last way led to
};

/// Finds the place to drive to when several poses are possible: where their predictions differ most for the
/// shortest path.
class Disambiguation {
 public:
  Disambiguation(CeilingForecast forecast, const DisambiguationParams& params)
      : forecast_(std::move(forecast)), params_(params) {}

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
  DisambiguationParams params_;
};

}  // namespace luminav
