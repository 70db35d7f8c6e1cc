#pragma once

#include <algorithm>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/ceiling_view.hpp"
#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/ceiling/seen_ceiling.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/wall_field.hpp"

namespace luminav {

/// What tells how likely an observation is at a pose: the building's fixtures and walls, what of them this robot sees
/// and hears, and by how much it errs.
struct ObservationModel {
  ObservationModel(const Building& building, const PriorMap& map, const RobotDescription& robot,
                   const ErrorParams& error_params)
      : fixtures(building.fixtures),
        is_complete(building.is_complete),
        seen(building.seen_from),
        view(robot.camera),
        walls(map, building.is_complete),
        ceiling_height(building.ceiling_height),
        wheel_base(robot.wheel_base),
        sonar_half_angle(robot.sonar.half_angle),
        errors(error_params) {}

  /// [m] from the camera up to the ceiling; never so little that errors of tilt and scale vanish.
  [[nodiscard]] double height_above_camera() const { return std::max(0.2, view.height_above_camera(ceiling_height)); }
  /// Distance [m] from the robot's middle beyond which no fixture is in view, by its centre: none is longer than 2 m.
  [[nodiscard]] double reach() const { return view.radius(ceiling_height) + 1.0; }

  FixtureMap fixtures;
  bool is_complete;  // whether all lamps are among them
  SeenCeiling seen;  // where they are in any case
  CeilingView view;
  WallField walls;
  double ceiling_height;    // [m]
  double wheel_base;        // [m]
  double sonar_half_angle;  // [rad]
  ErrorParams errors;
};

}  // namespace luminav
