#pragma once

#include <deque>
#include <luminav/grid_tile_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/world/scenario.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/report/run_report.hpp"
#include "tests/evaluation/report/trail_point.hpp"
#include "tests/support/fixture_visibility.hpp"

namespace luminav {

/// Watches a run on LCM, beside the simulator's truth, and says what it came to. Time is the stamps'; the same
/// messages give the same report.
class RunJudge {
 public:
  RunJudge(lcm::LCM& lcm, const Scenario& scenario, const WorldTruth& world);

  [[nodiscard]] const std::optional<sim_truth_t>& truth() const { return truth_; }
  [[nodiscard]] const std::optional<pose_t>& pose() const { return pose_; }
  [[nodiscard]] const std::optional<navigation_status_t>& navigation() const { return navigation_; }
  /// [s] since the first truth.
  [[nodiscard]] double elapsed() const;
  /// True position error of the newest pose [m].
  [[nodiscard]] double position_error() const { return position_error_; }
  [[nodiscard]] double heading_error() const { return heading_error_; }  // [rad]
  [[nodiscard]] const std::vector<TrailPoint>& trail() const { return trail_; }
  /// The live grid as the newest tiles have it; nothing before the first one.
  [[nodiscard]] std::optional<OccupancyGrid> grid() const;

  /// Everything but the goals' outcomes, which the caller knows.
  [[nodiscard]] RunReport report(std::vector<GoalResult> goals) const;

 private:
  void on_truth(const sim_truth_t& truth);
  void on_pose(const pose_t& pose);
  void on_odometry(const odometry_t& odometry) { odometry_ = odometry; }
  void on_navigation(const navigation_status_t& status) { navigation_ = status; }
  void on_tile(const grid_tile_t& tile);
  void on_node_status(const node_status_t& status);
  void judge_tracking(const pose_t& pose, const Pose2& truth, double seconds);
  void judge_carries(const pose_t& pose, const Pose2& truth);
  /// After a motion that the wheels do not tell, a pose may be wrong until a second after the first image that says so.
  void judge_mishap(const pose_t& pose, const Pose2& truth);
  [[nodiscard]] bool is_wrong() const;
  [[nodiscard]] std::optional<Pose2> truth_at(std::int64_t utime) const;

  Scenario scenario_;
  WorldTruth world_;
  FixtureVisibility visibility_;
  Subscriber subscriber_;

  std::optional<sim_truth_t> truth_;
  std::optional<pose_t> pose_;
  std::optional<odometry_t> odometry_;
  std::optional<navigation_status_t> navigation_;
  std::map<std::pair<int, int>, grid_tile_t> tiles_;  // newest by column and row; unpacked when somebody asks
  std::deque<sim_truth_t> recent_truth_;              // 3 s
  std::vector<TrailPoint> trail_;

  std::int64_t first_utime_ = 0;
  double driven_ = 0.0;
  double min_clearance_ = 10.0;
  double position_error_ = 0.0;
  double heading_error_ = 0.0;

  bool localized_ = false;
  double localized_s_ = 0.0;
  double localized_after_m_ = 0.0;
  double tracking_s_ = 0.0;
  double watched_s_ = 0.0;
  double ambiguous_s_ = 0.0;
  double posed_s_ = 0.0;  // in which there was a pose at all
  double confident_wrong_s_ = 0.0;
  double in_view_square_position_ = 0.0;
  double in_view_square_heading_ = 0.0;
  int in_view_count_ = 0;
  std::vector<double> position_errors_;  // [m] while TRACKING
  std::vector<double> heading_errors_;   // [rad]
  double nees_sum_ = 0.0;
  int nees_count_ = 0;

  double free_distance_ = 0.0;  // [m] on free stretches
  double free_time_ = 0.0;      // [s]
  double following_since_ = -1.0;

  bool carry_open_ = false;                      // carried and not yet tracking rightly again
  std::optional<std::int64_t> contradicted_at_;  // [us] first image since that carry that contradicts the belief
  bool carry_noticed_ = false;
  int carries_noticed_ = 0;
  int carries_recovered_ = 0;

  bool is_moved_ = false;                // otherwise than the wheels tell: carried, slipping or bumped
  bool mishap_open_ = false;             // it was, is TRACKING since, and no image since agreed with the belief
  std::optional<std::int64_t> told_at_;  // [us] first image since then that contradicts the belief

  struct ProcessFigures {
    double cpu_sum = 0.0;
    int count = 0;
    std::int64_t memory = 0;
  };
  std::map<std::string, ProcessFigures> processes_;
};

}  // namespace luminav
