#pragma once

#include <cstdint>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/jobs/job_executor.hpp"

namespace luminav {

/// What messages said of robot and drive, gathered from tick to tick.
class JobInputs {
 public:
  explicit JobInputs(SonarRing ring) : ring_(std::move(ring)) {}

  void take(const navigation_status_t& message) { navigation_ = message; }
  /// A possible one.
  void take(const pose_t& message) { pose_ = message; }
  /// Counts where the robot knows its pose alone.
  void take(const sonar_t& message);

  /// world_from_robot at a stamp [us], while it is known.
  [[nodiscard]] std::optional<Pose2> pose_at(std::int64_t utime) const;
  /// All that is known at the robot's stamp, `seconds` after the last time. Echoes, and what the planner said, are
  /// given out once.
  JobMoment moment(const robot_status_t& status, double seconds);

 private:
  SonarRing ring_;
  std::optional<navigation_status_t> navigation_;  // since the last tick
  std::optional<pose_t> pose_;
  std::vector<Echo> echoes_;  // since the last tick
};

}  // namespace luminav
