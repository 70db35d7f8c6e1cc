#pragma once

#include <functional>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {

/// Poses of the robot between the key frames of a survey: odometry carried from the one before to the one behind, with
/// what it misses there shared out along the way.
class SurveyedPath {
 public:
  /// `poses` are those of the frames.
  SurveyedPath(const std::vector<OdometryReading>& odometry, const std::vector<KeyFrame>& frames,
               const std::vector<Pose2>& poses);

  /// A point of the path.
  struct Stop {
    std::int64_t utime = 0;
    int part = 0;  // of the drive: between two of them nobody measured the motion
    Pose2 world_from_robot;
    double angular = 0.0;  // [rad/s]
  };
  /// One for each odometry reading between the first and the last key frame, in the order of time.
  [[nodiscard]] const std::vector<Stop>& stops() const { return stops_; }

 private:
  std::vector<Stop> stops_;
};

/// Draws what the sonars saw along a path, with nothing known before, as a mapping drive does. The map is as large as
/// what is known of the floor and what hangs `above` it.
PriorMap draw_sonar_map(const std::vector<SonarEcho>& echoes, const SurveyedPath& path, const RobotDescription& robot,
                        const std::vector<Eigen::Vector2d>& above = {});

}  // namespace luminav
