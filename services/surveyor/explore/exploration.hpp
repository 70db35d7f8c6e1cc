#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/surveyor/explore/frontier_search.hpp"

namespace luminav {

struct ExplorationParams {
  FrontierParams search;
  /// Tried one after the other when nothing is left: echoes of a door's posts draw it narrow or shut, but not as surely
  /// as a wall. The first is the planner's own; gaps that seem to lead nowhere come last, if much may lie behind.
  std::vector<Leniency> leniencies = {{0.8, 1.0, 0.3}, {2.4, 0.6, 0.7, true}, {3.2, 0.6, 0.7, true}, {3.2, 0.6, 1.0}};
  double search_period = 1.0;  ///< [s]
  double spent_share = 0.3;    ///< a goal is dropped when less than that share of what was hoped for is open still
  double patience = 20.0;      ///< [s] at one place on the way, until another goal is taken
  double dwell = 3.0;          ///< [s] at a goal that shows nothing, until that is believed
  int looks = 3;               ///< around in a row that find nothing, until that is believed
  int home_tries = 3;          ///< to drive home, the robot's last goal
};

/// What the planner says of the goal that it has.
struct GoalNews {
  std::int64_t goal_id = 0;
  bool is_over = false;
  bool has_arrived = false;
  bool is_paused = false;
  std::optional<Eigen::Vector2d> target;  // [m] world, of a goal that is not over
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
/// its sonars drew shut, drives home to where the survey began, looks once more from there (the room that it was in may
/// have been drawn shut) and is finished. Who takes the robot elsewhere ends it; who pauses it or engages a stop has it
/// wait.
class Exploration {
 public:
  enum class Phase { kIdle, kLooking, kDriving, kHome, kLastLook, kFinished };

  explicit Exploration(const ExplorationParams& params) : params_(params) {}

  /// `tried`: what a run before this one set out for.
  void begin(TriedFloor tried = {});
  /// No longer: the robot is to stand. `why` is a plain sentence.
  void end(std::int64_t now, const std::string& why);
  [[nodiscard]] bool is_active() const { return phase_ != Phase::kIdle && phase_ != Phase::kFinished; }
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
  [[nodiscard]] const TriedFloor& tried() const { return tried_; }
  /// Whether there is more of it since the last call.
  [[nodiscard]] bool take_news_of_tried() { return std::exchange(has_tried_, false); }
  [[nodiscard]] const OpenFloor& open_floor() const { return floor_; }

 private:
  void go(std::int64_t now, const Eigen::Vector2d& position);
  [[nodiscard]] bool is_mine(const GoalNews& news) const;
  /// True when nothing more comes of the goal.
  [[nodiscard]] bool judge_goal(std::int64_t now, const Eigen::Vector2d& robot);
  void choose(std::int64_t now, const FrontierSearch& found);
  void drive_home(std::int64_t now, bool is_over, bool has_moved);

  ExplorationParams params_;
  Phase phase_ = Phase::kIdle;
  std::optional<ExploreGoal> request_;
  std::int64_t goal_id_ = 0;
  Eigen::Vector2d sent_ = Eigen::Vector2d::Zero();  // [m] world, where to
  std::vector<Eigen::Vector2d> hoped_;              // [m] world, cells that were open round the goal when it was chosen
  TriedFloor tried_;
  bool has_tried_ = false;
  int drawing_ = 0;
  std::optional<GoalNews> news_;
  std::int64_t searched_ = 0;                        // [us]
  Eigen::Vector2d stood_ = Eigen::Vector2d::Zero();  // [m] world, where the robot was
  std::int64_t progress_ = 0;                        // [us] when it moved on last
  std::int64_t arrived_ = 0;                         // [us] there; 0: not yet
  int empty_ = 0;                                    // looks in a row that found nothing
  int home_tries_ = 0;                               // that failed
  std::size_t leniency_ = 0;                         // which of them
  OpenFloor floor_;
  std::string sentence_;
};

}  // namespace luminav
