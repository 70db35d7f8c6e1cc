#pragma once

#include <Eigen/Core>
#include <optional>

#include "services/common/geometry/pose2.hpp"
#include "services/controller/search/ceiling_forecast.hpp"

namespace luminav {

/// Where the robot may be, ready to map thousands of places.
struct PossiblePose {
  PointTransform world_from_odom;
  Pose2 odom_from_world;
  double weight = 0.0;   // what it counts as a rival
  double chance = 0.0;   // of being the truth
  double urgency = 1.0;  // how much sooner than others it should be looked at as the truth
};

/// What one possible pose predicts of a place.
struct PredictedView {
  const Fixture* fixture = nullptr;  // above it; nullptr = none
  Pose2 odom_from_fixture;
  bool is_wall = false;  // nobody can be there
};

/// What a pose predicts of a place [m, odom]; where sonar knows that the floor is free it is no wall for any. Nothing
/// where the building's file says nothing, and where a fixture would be at the border of the image, which may be seen
/// or not.
[[nodiscard]] std::optional<PredictedView> predict(const CeilingForecast& forecast, const PossiblePose& pose,
                                                   const Eigen::Vector2d& place, bool is_known_floor);

/// True if a robot at that place could not tell which of the two was predicted.
[[nodiscard]] bool look_alike(const PredictedView& a, const PredictedView& b);

}  // namespace luminav
