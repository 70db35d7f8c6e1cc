#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "drivers/simulator/people/people.hpp"
#include "drivers/simulator/world/contact_counter.hpp"
#include "drivers/simulator/world/dock_contact.hpp"
#include "drivers/simulator/world/floor.hpp"
#include "drivers/simulator/world/injected_faults.hpp"
#include "drivers/simulator/world/robot_model.hpp"
#include "drivers/simulator/world/scenario.hpp"
#include "drivers/simulator/world/scene.hpp"
#include "drivers/simulator/world/sonar_beam.hpp"
#include "drivers/simulator/world/world_truth.hpp"

namespace luminav {

/// What the wheels tell the microcontroller about one tick.
struct WheelReport {
  double left = 0.0;     // [m] as the encoders see it
  double right = 0.0;    // [m]
  bool stalled = false;  // the wheels are blocked
  // Of a base that feels what it touches and where the floor ends:
  int bumpers = 0;         // bit mask, bit 0 = left
  int cliffs = 0;          // bit mask of four sensors, bit 0 = leftmost
  bool drop_left = false;  // the wheel hangs in a hole
  bool drop_right = false;
};

/// What is true now.
struct WorldState {
  Pose2 world_from_robot;
  double roll = 0.0;     // [rad] of the floor, robot frame
  double pitch = 0.0;    // [rad]
  double linear = 0.0;   // [m/s] along the robot's x
  double angular = 0.0;  // [rad/s]
  bool carried = false;
  std::int32_t carries = 0;
  double clearance = Separation::kNoneNear;  // [m]
  double daylight = 0.5;                     // 0..1
  bool camera_unplugged = false;
  bool serial_unplugged = false;
  std::vector<std::int8_t> lamp_states;        // per fixture, lamp_state.hpp
  std::map<std::int32_t, Pose2> lamp_offsets;  // by fixture index: displaced by events [m, rad]
  std::vector<bool> door_open;                 // per door
};

/// The simulated world: a robot on a floor between walls, obstacles, doors and people, and the scenario's events. It
/// knows no clock, no messages and no bytes; the same truth, seed and commands give the same world.
class World {
 public:
  static constexpr double kTick = 0.010;  // [s]

  World(std::uint64_t seed, const WorldTruth& truth);
  World(const World&) = delete;  // the scene refers to the truth
  World& operator=(const World&) = delete;

  /// One tick of kTick.
  WheelReport step(const MotorCommand& command);
  /// One pulse of a sonar disc [m].
  double measure_sonar(int disc);
  [[nodiscard]] int sonar_discs() const { return sonar_.discs(); }

  /// Somebody comes up behind the robot and follows it; false when there is no room for him.
  bool add_visitor(const VisitorHabit& habit) { return people_.add_visitor(habit, robot_among_people()); }
  /// Somebody stands there from now on; false when the robot does.
  bool add_bystander(const Eigen::Vector2d& position) { return people_.add_bystander(position, robot_among_people()); }
  /// Those who follow go away, or those who stand.
  void remove_visitors() { people_.remove_visitors(); }
  void remove_bystanders() { people_.remove_bystanders(); }
  /// Who follows it, or is about to; null = nobody.
  [[nodiscard]] const Visitor* visitor() const { return people_.visitor(); }
  /// The robot stands in the dock and its contacts have met.
  [[nodiscard]] bool is_on_charger() const { return dock_.has_met(); }

  [[nodiscard]] const WorldState& state() const { return state_; }
  [[nodiscard]] const std::vector<Disc>& people() const { return scene_.people(); }
  [[nodiscard]] const ContactCounter& contacts() const { return contacts_; }
  /// [s] since the beginning.
  [[nodiscard]] double time() const { return static_cast<double>(ticks_) * kTick; }

 private:
  struct Carry {
    Pose2 from;
    Pose2 to;
    double begin = 0.0;     // [s]
    double duration = 0.0;  // [s]
  };
  struct Bump {
    Pose2 per_tick;  // displacement, world
    int ticks = 0;   // that remain
  };

  void start_due_events();
  void start(const ScenarioEvent& event);
  void move_doors();
  [[nodiscard]] RobotAmongPeople robot_among_people() const {
    return {footprint_, state_.world_from_robot, state_.carried};
  }
  void carry();
  WheelReport drive(const MotorCommand& command);
  void push();
  /// Bumpers, cliff sensors and dropped wheels of a Create 2 where it stands.
  void feel(WheelReport& report);
  /// Moves the robot unless it would touch something it is free of now; returns what it would touch.
  std::optional<Separation> try_move(const Pose2& next);
  void measure_motion(const Pose2& before);

  WorldTruth truth_;
  std::deque<ScenarioEvent> events_;  // still to come, by time
  Scene scene_;
  RobotModel robot_;
  SonarBeam sonar_;
  Floor floor_;
  People people_;
  DockContact dock_;
  InjectedFaults faults_;
  ContactCounter contacts_;
  WorldState state_;
  Polygon footprint_;      // world
  Separation separation_;  // of the footprint
  std::optional<Carry> carry_;
  Bump bump_;
  std::int64_t ticks_ = 0;
  double stalled_until_ = 0.0;  // [s]
  std::vector<bool> door_wanted_open_;
};

}  // namespace luminav
