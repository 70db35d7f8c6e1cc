#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/world/luminaire_kind.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// State of the light when a run begins; events change it.
struct LightingPlan {
  double daylight = 0.5;     // 0..1
  std::vector<int> off;      // fixture ids
  std::vector<int> half;     // one of two tubes burns
  std::vector<int> flicker;  // on and off several times a second
  double off_ratio = 0.0;    // 0..1 of all fixtures, drawn by seed
};

/// What an obstacle is made of: sonar sees boxes well and the others badly, so they are reported apart.
enum class ObstacleKind { kBox, kLegs, kGlass, kTable };

/// Something that stands there and that the map does not know.
struct Obstacle {
  std::optional<Pose2> world_from_obstacle;  // nothing: drawn from the free space by seed
  double length = 0.5;                       // [m] along its x
  double width = 0.4;                        // [m]
  ObstacleKind kind = ObstacleKind::kBox;
};

/// Walks to and fro along the waypoints; stops 0.1 m before touching the robot.
struct WalkingPerson {
  std::vector<Eigen::Vector2d> waypoints;  // [m] world; empty: two points drawn from the free space by seed
  double speed = 0.8;                      // [m/s]
};

/// A charger that the robot drives onto; it charges where the robot stands near enough to the pose.
struct Dock {
  std::string place;              // its name in the building
  Pose2 pose;                     // world
  double reach = 0.08;            // [m]
  double heading = radians(6.0);  // [rad]
  double contact = 0.9;           // probability that the contacts meet, drawn each time the robot comes
};

/// Jobs that are drawn by seed: what is ordered, and how people take part.
struct JobPlan {
  int count = 0;           // 0 = none: the scenario has goals or drives
  double time = 25'200.0;  // [s] in which they are ordered
  int kills = 0;           // of the job service, at drawn times
  bool only_guides = false;
};

struct ScenarioGoal {
  Pose2 pose;
  bool has_theta = false;
  std::string place;  // "" = given by x, y; else already resolved to the pose
  bool expect_refused = false;
  double tolerance = 0.25;  // [m] within which the evaluation counts it as reached
};

/// Teleoperation for a while.
struct DriveStep {
  double linear = 0.0;    // [m/s]
  double angular = 0.0;   // [rad/s]
  double duration = 0.0;  // [s]
};

enum class EventKind {
  kCarry,
  kSlip,
  kBump,
  kLight,
  kDoor,
  kUnplug,
  kLamp,
  kDeafen,
  kStick,
  kFreeze,
  kCover,
  kKill,
  kClock
};

/// Something that happens to the robot or its world at a time. Only the fields of its kind count.
struct ScenarioEvent {
  double at = 0.0;  // [s] since the start
  EventKind kind = EventKind::kCarry;
  Pose2 pose;                      // carry: where to, world; bump and lamp: displacement, world
  bool has_place = true;           // carry; false: drawn from the free space by seed
  double duration = 0.0;           // [s] carry, slip, unplug, and of senses that fail
  double factor = 1.0;             // slip: ground covered per wheel travel
  std::optional<double> daylight;  // light: 0..1
  std::vector<int> on;             // light: fixture ids
  std::vector<int> off;            // light: fixture ids
  int id = 0;                      // door or lamp
  bool open = true;                // door
  std::string device;              // unplug: "camera" | "serial"; freeze: "camera" | "encoder_left" | "encoder_right"
  std::vector<int> discs;          // deafen, stick: sonar discs from 0; empty = all
  std::string process;             // kill; executed by the program that runs the scenario
  std::string host;                // clock
  double step = 0.0;               // [s] clock
};

/// 1-sigma of the truth around the belief; the defaults are the contract of all reports.
struct WorldSpread {
  bool calibrated = false;          // robot's and camera's constant errors a tenth; fixtures 3 mm and 0.2 degrees
  double wheel_scale = 0.01;        // fraction
  double wheel_ratio = 0.005;       // fraction
  double wheel_base = 0.01;         // fraction
  double odometry_position = 0.01;  // [m per sqrt m]
  double odometry_heading = radians(0.5);  // [rad per sqrt m]
  double camera_tilt = radians(0.5);       // [rad] per axis
  double camera_yaw = radians(0.5);        // [rad]
  double camera_height = 0.01;             // fraction
  double time_offset = 0.020;              // [s]
  double row_time = 0.025;                 // [s] a frame; not drawn: the truth's value
  double residual_k1 = 0.01;
  double fixture_position = 0.010;        // [m] per axis
  double fixture_heading = radians(0.5);  // [rad]
  double ceiling_height = 0.005;          // fraction
  double floor_tilt = radians(0.1);       // [rad] per axis, drawn anew every metre
  double min_unlit_darker = 10.0;         // [grey levels] an unlit fixture is darker than its tile
  double max_unlit_darker = 40.0;         // [grey levels]
  double grey_noise = 4.0;                // [grey levels]
  std::vector<LuminaireKind> luminaires;  // what the fixtures are built as is drawn from these; empty: panels
};

/// A place without a floor, such as stairs that lead down. Only a base with cliff sensors notices it.
struct Hole {
  Pose2 pose;           // world_from_hole, its middle
  double length = 1.0;  // [m] along its x
  double width = 1.0;   // [m]
};

/// One run: what the simulator, the simulated frame source, the demo and the evaluation do.
struct Scenario {
  std::filesystem::path file;
  std::filesystem::path building_file;       // what the robot is told
  std::filesystem::path true_building_file;  // what the world is drawn around; [truth], else the same
  std::filesystem::path robot_file;
  std::string base = "p3dx";  // of that file
  std::string name;           // the file's stem
  std::uint64_t seed = 1;
  double duration = 600.0;     // [s] simulated; then the run has failed
  std::optional<Pose2> start;  // nothing: drawn from the free space by seed
  bool start_known = false;    // the demo tells the localizer
  LightingPlan lighting;
  WorldSpread world;
  std::vector<Obstacle> obstacles;
  std::vector<WalkingPerson> people;
  std::vector<Hole> holes;
  std::optional<Dock> dock;
  double battery_voltage = 12.6;  // [V] at rest, when the run begins
  JobPlan jobs;
  std::vector<ScenarioGoal> goals;
  std::vector<DriveStep> drives;
  std::vector<ScenarioEvent> events;
};

/// Reads a scenario strictly; places are looked up in its building. Throws ConfigurationError.
Scenario read_scenario(const std::filesystem::path& file);

}  // namespace luminav
