#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/scenario.hpp"
#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/split_mix.hpp"

namespace luminav {

/// How the wheels differ from what the robot's file says.
struct TrueWheels {
  double believed_base = 0.33;  // [m] what the microcontroller turns turn rates into wheel speeds with
  double scale_left = 1.0;      // ground covered per metre that the encoders report
  double scale_right = 1.0;
  double noise_position = 0.0;  // [m per sqrt m] white
  double noise_heading = 0.0;   // [rad per sqrt m] white
};

/// The true world of a run, drawn from the scenario's seed around what the robot believes. The simulator and the
/// simulated frame source draw it each for itself and get the same.
struct WorldTruth {
  Building building;       // true fixtures, elements and ceiling height
  PriorMap walls;          // the building's map as it is; empty when it has none
  RobotDescription robot;  // true camera (tilt, yaw, height, residual k1, row time, time offset), true wheel base
  TrueWheels wheels{};
  double floor_tilt = 0.0;                // [rad] 1-sigma per axis, changing every metre
  double grey_noise = 4.0;                // [grey levels]
  std::vector<double> unlit_darker;       // [grey levels] per fixture
  std::vector<LuminaireKind> luminaires;  // per fixture
  std::vector<std::int8_t> lamp_states;   // per fixture when the run begins: lamp_state.hpp, as in SIM_TRUTH
  double daylight = 0.5;                  // 0..1 when the run begins
  Pose2 start;                            // true world_from_robot
  std::vector<Obstacle> obstacles;        // all with a pose
  std::vector<WalkingPerson> people;      // all with waypoints
  std::vector<Polygon> holes;             // in the floor
  bool feels_touch = false;               // the base has bumpers and cliff sensors
  std::vector<ScenarioEvent> events;      // all with a place
  std::optional<Dock> dock;
  double battery_voltage = 12.6;  // [V] at rest, when the run begins
  std::string table;              // the spread and what was drawn, for the report
  std::string hash;               // of that table
};

/// Draws the truth. Throws ConfigurationError when the scenario is impossible: a start in a wall, an unknown fixture
/// id.
WorldTruth draw_world(const Scenario& scenario, const Building& believed, const RobotDescription& robot);

/// Draws a point of the map's free space with at least `clearance` [m] to everything that is not free; the space must
/// be connected to the largest free region. Same generator state, same point.
Eigen::Vector2d draw_free_point(const PriorMap& map, double clearance, SplitMix& generator);

}  // namespace luminav
