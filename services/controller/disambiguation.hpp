#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/controller/ceiling_forecast.hpp"
#include "services/controller/search_map.hpp"

namespace luminav {

/// Where the robot may be: one of the localizer's HYPOTHESES.
struct PoseAlternative {
  Pose2 world_from_odom;
  double weight = 0.0;
};

struct DisambiguationParams {
  double reach = 10.0;                  // [m] around the robot places are looked at
  double step = 0.2;                    // [m] between them
  int most = 48;                        // alternatives looked at
  double flattening = 0.5;              // power of the weights: all rivals have to go, the unlikely ones too
  double clearance = 0.2;               // [m] least room that sonar must leave
  double comfortable = 0.4;             // [m] less room costs double
  double least_free = 0.3;              // share of the alternatives that must have room where no sonar looked yet
  double least_free_if_heard = 0.1;     // likewise where sonar found it free
  double sure_within = 0.65;            // of the view's radius: a fixture farther off may be seen or not
  double least_free_in_narrows = 0.35;  // likewise where sonar leaves less room than `clearance`
  double same_place = 0.6;              // [m] fixtures as near as that are seen as one
  double same_axis = 0.4;               // [rad] and no more turned than that
  double seen_and_not = 0.55;           // what it tells when a fixture is seen that the rival has not, 1 = everything
  double missed = 0.25;                 // likewise one that the rival has and that is not there
  double wall = 0.25;                   // likewise to drive where the rival has a wall
  double any_fixture = 0.05;            // worth of a fixture that all have and none saw yet
  double least_worth = 0.02;            // less is not worth a way
  double head_start = 1.5;              // [m] added to each way, so that a little worth close by does not win
  double faithfulness = 3.0;            // what another place must be better than where it is heading
};

/// Finds the place to drive to when several poses are possible: where what they foretell differs most for the least
/// way. In the odometry frame; floor that sonar knows counts as it is if any likely alternative has room there, the
/// rest by what their walls say.
class Disambiguation {
 public:
  Disambiguation(CeilingForecast forecast, const DisambiguationParams& params)
      : forecast_(std::move(forecast)), params_(params) {}

  /// Way [m, odom] from `place` on to the most telling ground; `heading_for`: where the last way led to. Nothing if no
  /// place within reach tells them apart.
  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> way(
      const Eigen::Vector2d& place, std::span<const PoseAlternative> alternatives, const SearchMap& map,
      const std::optional<Eigen::Vector2d>& heading_for) const;

 private:
  /// Alternatives that foretell the same of a place.
  struct View {
    const Fixture* fixture = nullptr;
    Pose2 odom_from_fixture;
    bool is_wall = false;
    double weight = 0.0;  // sums of theirs, see LookedAt
    double chance = 0.0;
  };
  /// An alternative ready to map thousands of places.
  struct LookedAt {
    PointTransform world_from_odom;
    Pose2 odom_from_world;
    double weight = 0.0;  // flattened: what it counts as a rival
    double chance = 0.0;  // of being the truth
  };
  [[nodiscard]] std::vector<LookedAt> chosen(std::span<const PoseAlternative> alternatives) const;
  [[nodiscard]] double free_share(const Eigen::Vector2d& place, std::span<const LookedAt> alternatives) const;
  /// Metres that a metre there counts for; infinite: no way leads through.
  [[nodiscard]] double price(const Eigen::Vector2d& place, std::span<const LookedAt> alternatives,
                             const SearchMap& map) const;
  [[nodiscard]] double worth(const Eigen::Vector2d& place, std::span<const LookedAt> alternatives, const SearchMap& map,
                             std::vector<View>& views) const;
  [[nodiscard]] bool look_alike(const View& a, const View& b) const;

  CeilingForecast forecast_;
  DisambiguationParams params_;
};

}  // namespace luminav
