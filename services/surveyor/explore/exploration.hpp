#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/surveyor/explore/frontier_search.hpp"

namespace luminav {

struct ExplorationParams {
  FrontierParams search;
  /// Evidence above which a cell is occupied, weaker walls taken for doors one after the other: echoes of its posts
  /// draw a door shut, but not as surely as a wall. The first is the mapper's own.
  std::vector<double> walls = {0.8, 1.8, 2.4};
  double search_period = 1.0;  ///< [s]
  double spent_share = 0.3;    ///< a goal from which less than that share of what was hoped for is left is dropped
  double patience = 45.0;      ///< [s] without coming nearer, until another goal is taken
  int looks = 3;               ///< around in a row that find nothing, until that is believed
  int max_attempts = 6;        ///< at one place, good or bad, after which it is left alone
};

/// What the planner says of the goal that it has.
struct GoalNews {
  std::int64_t goal_id = 0;
  bool is_over = false;
  bool has_arrived = false;
  bool is_paused = false;
  double distance_left = 0.0;  // [m]
  std::string cause;
};

/// A request to the planner; to be repeated until it echoes the id.
struct ExploreGoal {
  std::int64_t id = 0;
  bool is_cancel = false;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // [m] world
};

/// What is known when the exploration has to decide.
struct Surroundings {
  const OccupancyGrid& grid;
  std::vector<Eigen::Vector2d> looks;  // [m, world] where images were taken
  Pose2 world_from_robot;
  int drawing = 0;  // of the grid: a new one may have moved everything a little
};

/// Explores: goes where most is to be seen for the way there until nothing that it can reach is left, tries doors that
/// its sonars drew shut, drives home to where the survey began and is finished. Who takes the robot ends it.
class Exploration {
 public:
  enum class Phase { kIdle, kLooking, kDriving, kHome, kFinished };

  explicit Exploration(const ExplorationParams& params) : params_(params) {}

  void begin();
  /// No longer: the robot is to stand. `why` is a plain sentence.
  void end(std::int64_t now, const std::string& why);
  [[nodiscard]] bool is_active() const {
    return phase_ == Phase::kLooking || phase_ == Phase::kDriving || phase_ == Phase::kHome;
  }
  [[nodiscard]] Phase phase() const { return phase_; }

  void hear(const GoalNews& news);
  /// True once a search period.
  [[nodiscard]] bool is_due(std::int64_t now) const;
  /// Looks round and decides; to be called when it is due.
  void update(std::int64_t now, const Surroundings& around);

  /// What the planner should be told; nothing: it knows.
  [[nodiscard]] const std::optional<ExploreGoal>& request() const { return request_; }
  /// What the robot is at, in one plain sentence; "" = nothing.
  [[nodiscard]] const std::string& sentence() const { return sentence_; }
  [[nodiscard]] const OpenFloor& open_floor() const { return floor_; }

 private:
  /// What could not be seen from a place, or on the way there.
  struct Failure {
    std::vector<Eigen::Vector2d> cells;  // [m] world
    int drawing = 0;                     // until another one, or
    bool is_final = false;               // for good
  };
  void go(std::int64_t now, const Eigen::Vector2d& position);
  /// True when nothing more comes of the goal.
  [[nodiscard]] bool judge_goal(std::int64_t now);
  /// The goal was not what was hoped for: the robot drives into what is left there, then that is given up.
  void note_failure(std::int64_t now, const FrontierSearch& found);
  void choose(std::int64_t now, const FrontierSearch& found);
  void drive_home(std::int64_t now, bool is_over, bool has_moved);
  [[nodiscard]] int attempts_at(const Eigen::Vector2d& position) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> given_up() const;

  ExplorationParams params_;
  Phase phase_ = Phase::kIdle;
  std::optional<ExploreGoal> request_;
  std::int64_t goal_id_ = 0;
  Prospect goal_;
  std::vector<Eigen::Vector2d> hoped_;     // [m] world, cells that were open round the goal when it was chosen
  std::vector<Eigen::Vector2d> attempts_;  // [m] world, goals that came to an end, good or bad
  bool looks_closer_ = false;              // it was there, and drives into what is left
  int drawing_ = 0;
  std::optional<GoalNews> news_;
  std::int64_t searched_ = 0;  // [us]
  double min_left_ = 0.0;      // [m] of the way to the goal,
  std::int64_t progress_ = 0;  // [us] and when it came that near
  int empty_ = 0;              // looks in a row that found nothing
  std::size_t wall_ = 0;       // which of the walls
  std::vector<Failure> failures_;
  OpenFloor floor_;
  std::string sentence_;
};

}  // namespace luminav
