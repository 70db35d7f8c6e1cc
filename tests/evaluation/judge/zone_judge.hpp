#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/zone_timetable.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

/// Watches by the truth how a robot that knows where it is keeps the rules of the building's zones.
class ZoneJudge {
 public:
  /// By `local_clock` zones have hours.
  ZoneJudge(lcm::LCM& lcm, std::vector<Zone> zones, LocalClock local_clock, const WorldTruth& world);

  /// Length [m] of the shortest way that the zones in force allow, for a robot that needs 0.4 m to each side; negative:
  /// none.
  [[nodiscard]] double shortest(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  /// A goal was reached by a way of `driven` [m] that the shortest allowed one is to be compared with.
  void compare(double driven, double shortest);
  /// Nothing where there are no zones.
  [[nodiscard]] std::optional<ZoneResult> result() const;
  /// The first rule that was broken, one sentence; "" = none was. A goal refused for another reason than a zone counts.
  [[nodiscard]] std::string failure(const std::vector<GoalResult>& goals) const;

 private:
  void on_pose(const pose_t& pose);
  void on_truth(const sim_truth_t& truth);
  void judge_keep_out(const Pose2& robot, double seconds);
  void judge_lanes(const Pose2& robot);

  ZoneTimetable zones_;
  WorldTruth world_;
  ZoneResult result_;
  std::int64_t tracking_since_ = 0;              // [us] 0 = it is not
  std::int64_t last_truth_ = 0;                  // [us]
  bool was_outside_ = false;                     // of all keep-out zones, since it knows its pose
  double inside_ = 0.0;                          // [s] in a keep-out zone that it found itself in
  std::vector<std::optional<double>> progress_;  // [m] farthest along each one-way zone that it is in
  Subscriber subscriber_;
};

}  // namespace luminav
