#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/controller/controller_config.hpp"
#include "services/controller/following/local_map.hpp"
#include "services/controller/following/path_follower.hpp"
#include "services/controller/following/progress_monitor.hpp"
#include "services/controller/following/speed_limit.hpp"
#include "services/controller/safety/escape.hpp"
#include "services/controller/safety/stop_logic.hpp"
#include "services/controller/safety/turn_search.hpp"
#include "services/controller/safety/zones.hpp"
#include "services/controller/search/wander.hpp"

namespace luminav {

/// Who wishes to move the robot.
enum class ControlTask { kNone, kWander, kFollow, kTeleop };

/// The numbers are those of CONTROL_STATUS.
enum class ControlState : std::int8_t {
  kIdle = 0,
  kWandering = 1,
  kFollowing = 2,
  kTurning = 3,
  kAtGoal = 4,
  kYielding = 5,
  kEscaping = 6,
  kStuck = 7,
  kStopped = 8,
  kTeleop = 9
};

struct ControlInput {
  std::int64_t now = 0;    // [us]
  double duration = 0.05;  // [s] since the last step
  bool is_again = false;   // replaces the last step, of the same instant: more is known of it
  ControlTask task = ControlTask::kNone;
  std::string task_reason;          // why there is nothing to do, plain sentence
  std::optional<std::string> halt;  // stands still at once, and why
  Pose2 odom_from_robot;
  std::optional<Pose2> world_from_robot;  // only while TRACKING
  const OccupancyGrid* grid = nullptr;    // nothing received yet: nullptr
  DriveTwist teleoperation;
  std::optional<SpeedLimit> speed_limit;      // that somebody asks for
  std::vector<ObstaclePoint> echoes;          // robot frame
  std::vector<ObstaclePoint> remembered;      // echoes with a longer memory, for choosing a direction while wandering
  std::vector<SonarFiring> firings;           // newest of each disc, while wandering
  std::vector<PoseAlternative> alternatives;  // poses that are possible, while it does not know its pose
  SenseAges ages;
};

struct ControlOutput {
  DriveTwist twist;
  ControlState state = ControlState::kIdle;
  std::string reason;
  FollowStep follow;
  double clearance = 10.0;                // [m]
  double seconds_without_progress = 0.0;  // [s]
};

/// One step of control: a wish from wandering, path or person, smoothed, and cut by the stop logic; with patience for
/// people, and escapes where there is no progress.
class Controller {
 public:
  explicit Controller(const ControllerConfig& config);

  void set_path(const FollowedPath& path) { follower_.set_path(path); }
  /// Obeys these from the next step on.
  void set_zones(const std::vector<Zone>& zones);
  ControlOutput step(const ControlInput& input);
  /// The odometry jumped.
  void forget_odometry();

  [[nodiscard]] const FollowedPath& path() const { return follower_.path(); }

 private:
  struct Escape {
    EscapeMove move;
    std::int64_t start = 0;  // [us]
  };
  void enter(ControlTask task, const ControlInput& input);
  /// Takes up what stands around the robot, and where it must not go.
  void look_around(const ControlInput& input);
  /// What one-way zones leave of a wish: against one the robot drives as fast as it can still stop within its room.
  [[nodiscard]] DriveTwist by_lanes(const DriveTwist& wanted, const ControlInput& input, ControlOutput& output) const;
  /// What slow zones leave of it.
  [[nodiscard]] DriveTwist by_slow_zones(const DriveTwist& wanted, const ControlInput& input,
                                         ControlOutput& output) const;
  /// No faster than somebody asks for, whoever drives.
  static DriveTwist by_limit(const DriveTwist& wanted, const std::optional<SpeedLimit>& limit, ControlOutput& output);
  /// Where the outline reaches into a keep-out zone of a possible pose, leaves only what leads no deeper.
  void keep_out_of_zones(const ControlInput& input, StopVerdict& verdict) const;
  void look_for_people(std::int64_t now);
  [[nodiscard]] bool has_met_people(std::int64_t now) const;
  [[nodiscard]] DriveTwist with_care(const DriveTwist& wanted, double nearest) const;
  void hold_still(std::int64_t now, const Pose2& place, const DriveTwist& wanted, double nearest, StopVerdict& verdict);
  DriveTwist wish(const ControlInput& input, ControlOutput& output);
  /// Searches for the pose as the building's file allows.
  DriveTwist search(const ControlInput& input, ControlOutput& output);
  /// True if the task may move the robot from its place.
  [[nodiscard]] bool may_travel(ControlTask task) const;
  void follow(const ControlInput& input, ControlOutput& output);
  [[nodiscard]] std::optional<DriveTwist> escape_twist(std::int64_t now) const;
  /// What a bumper feels it leaves at once, the way it came.
  void leave_what_it_touches(const ControlInput& input);
  void begin_escape(const ControlInput& input, bool by_unknown, ControlOutput& output);
  /// Returns the seconds since the last progress. While escapes go in circles `output` counts from the first of them.
  double judge_progress(const ControlInput& input, const StopVerdict& verdict, ControlOutput& output);
  /// Ends the escape when its time is over or the stop logic blocks it.
  void end_escape(std::int64_t now, const StopVerdict& verdict);
  void wait_or_escape(const ControlInput& input, const StopVerdict& verdict, ControlOutput& output);

  ControllerConfig config_;
  StopLogic stop_logic_;
  PathFollower follower_;
  Wander wander_;
  TurnSearch turn_search_;
  ProgressMonitor progress_;
  Zones zones_;
  const Zone* quiet_ = nullptr;  // the zone that it searches in, more likely than not
  Obstacles obstacles_;          // of this step: echoes and known walls
  CommandRamp ramp_;
  ControlTask task_ = ControlTask::kNone;
  std::optional<Escape> escape_;
  int escapes_ = 0;                  // since it got away from the place of the first
  Pose2 escape_place_;               // where progress is counted, of the first
  std::int64_t escape_since_ = 0;    // [us] of the first
  std::int64_t standing_since_ = 0;  // [us] it wants to move and may not; 0 = it moves
  std::int64_t next_escape_ = 0;     // [us] not before
  std::int64_t hold_since_ = 0;      // [us] it stands still for somebody; 0 = it doesn't
  std::int64_t next_hold_ = 0;       // [us] not before
  std::int64_t people_seen_ = 0;     // [us] something came towards it
};

}  // namespace luminav
