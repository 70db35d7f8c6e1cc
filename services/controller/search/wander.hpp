#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "services/controller/following/steady_heading.hpp"
#include "services/controller/following/virtual_forces.hpp"
#include "services/controller/safety/stop_logic.hpp"
#include "services/controller/search/disambiguation.hpp"
#include "services/controller/search/search_map.hpp"

namespace luminav {

struct WanderParams {
  double speed = 0.4;              // [m/s]
  double angular = radians(45.0);  // [rad/s]
  double look_around = 10.0;       // [m] it first drives by free distance alone, then leaves for new ground
  double plan_every = 1.0;         // [s]
  SteadyHeadingParams heading{.free_heading = {.half_width = 0.28}};
};

/// What wandering goes by.
struct WanderInput {
  std::int64_t now = 0;  // [us]
  Pose2 odom_from_robot;
  const Obstacles& obstacles;                     // fresh: steering goes by them
  std::span<const ObstaclePoint> remembered;      // robot frame: directions are chosen by them
  std::span<const SonarFiring> firings;           // newest of each disc
  std::span<const PoseAlternative> alternatives;  // poses that are possible
};

/// Covers ground until the localizer knows where it is: drives to where the possible poses predict different things,
/// and where nothing tells them apart by sonar alone to the nearest free ground that it has
/// not been near, out by the door once a room is known. Where there is none it drives towards the direction with the
/// most unvisited free distance, remembers in the odometry frame where it has been and which directions led nowhere.
/// Deterministic.
class Wander {
 public:
  Wander(const WanderParams& params, const SonarRing& ring, const StopLogic& stop_logic, CeilingForecast forecast)
      : params_(params),
        stop_logic_(stop_logic),
        map_(ring),
        heading_(params.heading),
        disambiguation_(std::move(forecast)) {}

  /// Returns a wish only; the stop logic has the last word.
  DriveTwist step(const WanderInput& input);
  /// The odometry jumped, or wandering is over.
  void clear();
  /// The current direction did not work: the stop logic refused it.
  void give_up(std::int64_t now, const Pose2& odom_from_robot);
  /// Rest of the turn on the spot that it wishes for [rad]; 0 = none.
  [[nodiscard]] double turn_left() const { return turn_.left; }

 private:
  struct Failure {
    std::int64_t utime = 0;
    Eigen::Vector2d place;  // [m] odom
    double heading = 0.0;   // [rad] odom
  };
  struct PathToNewGround {
    std::vector<Eigen::Vector2d> points;  // [m] odom; empty: none that it knows
    std::int64_t planned = 0;             // [us]
    std::int64_t approached = 0;          // [us] when it last came nearer to the end
    double left = 0.0;                    // [m] least until then
  };
  /// Near a place since then.
  struct Stay {
    std::optional<Eigen::Vector2d> place;  // [m] odom
    std::int64_t since = 0;                // [us]
  };
  /// On the spot.
  struct Turn {
    bool is_to_new_heading = false;
    double target = 0.0;  // [rad] odom, of that
    bool is_to_path = false;
    bool is_long = false;  // the long way round to the path
    double sign = 1.0;
    double left = 0.0;  // [rad]
  };
  using Square = std::pair<int, int>;
  [[nodiscard]] Square square_at(const Eigen::Vector2d& place) const;
  [[nodiscard]] double worth(double direction, std::int64_t now, const Pose2& odom_from_robot,
                             std::span<const ObstaclePoint> obstacles) const;
  void plan(const WanderInput& input);
  [[nodiscard]] DriveTwist follow_path(double duration, const WanderInput& input);
  [[nodiscard]] DriveTwist explore(double duration, const WanderInput& input);
  [[nodiscard]] DriveTwist steer(double direction, double duration, const WanderInput& input);
  /// Sign of the way round to a heading [rad, robot frame]: the short one unless only the long one is free.
  [[nodiscard]] double turn_side(double angle, const Obstacles& obstacles) const;
  void decide(bool is_blocked, std::int64_t now, const Pose2& odom_from_robot,
              std::span<const ObstaclePoint> remembered);
  [[nodiscard]] bool stays(std::int64_t now, const Eigen::Vector2d& place);
  void end_path(const Eigen::Vector2d& place);
  void note_failure(std::int64_t now, const Pose2& odom_from_robot, double heading);

  WanderParams params_;
  const StopLogic& stop_logic_;
  std::map<Square, double> visits_;  // [s] spent there
  std::deque<Failure> failures_;
  SearchMap map_;
  SteadyHeading heading_;  // in the odometry frame
  Disambiguation disambiguation_;
  double driven_ = 0.0;                        // [m]
  double faded_at_ = 0.0;                      // [m] of it
  std::optional<Eigen::Vector2d> last_place_;  // [m] odom
  std::optional<Eigen::Vector2d> began_at_;    // [m] odom, where it began to look
  PathToNewGround path_;
  Stay stay_;
  std::int64_t last_step_ = 0;                 // [us]
  std::optional<Eigen::Vector2d> decided_at_;  // [m] odom, place of the last decision
  Turn turn_;
  Eigen::Vector2d repulsive_ = Eigen::Vector2d::Zero();
};

}  // namespace luminav
