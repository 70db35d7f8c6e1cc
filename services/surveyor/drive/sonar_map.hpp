#pragma once

#include <optional>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/mapper/grid_mapper.hpp"
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

/// What the sonars see along a path, as a mapping drive draws it; the path may go on.
class SonarMap {
 public:
  /// Nothing is known before.
  SonarMap(const RobotDescription& robot, const GridGeometry& geometry);
  /// An older map is, whose walls explain the echoes that come from them.
  SonarMap(const RobotDescription& robot, const PriorMap& known);

  /// An echo is drawn when the path has gone on beyond it. One from before the last stop but one never is.
  void hear(const SonarEcho& echo);
  /// Draws up to the stop before: echoes come after the odometry of their time.
  void go_on(const SurveyedPath::Stop& stop);

  [[nodiscard]] GridMapper& mapper() { return mapper_; }
  [[nodiscard]] const OccupancyGrid& grid() const { return mapper_.grid(); }

 private:
  void draw_until(const SurveyedPath::Stop& next);
  void draw(const SonarEcho& echo, const SurveyedPath::Stop& next);

  RobotDescription robot_;
  GridMapper mapper_;
  std::vector<SonarEcho> waiting_;
  std::optional<SurveyedPath::Stop> last_;  // up to here it is drawn
  std::optional<SurveyedPath::Stop> next_;
};

/// A grid that reaches `margin` [m] beyond the stops, of which there is one at least. Throws std::runtime_error for one
/// that is too large for a map.
GridGeometry geometry_around(const std::vector<SurveyedPath::Stop>& stops, double margin);

/// A map of which nothing is known.
PriorMap empty_map(const GridGeometry& geometry);

/// The map of a path as far as it goes, over what was known before.
SonarMap draw_along(const std::vector<SonarEcho>& echoes, const std::vector<SurveyedPath::Stop>& stops,
                    const RobotDescription& robot, const PriorMap& known);

/// Draws what the sonars saw along a path, as a mapping drive does. The map is as large as what is known of the floor
/// and what hangs `above` it. With an older map in the same frame, its cells hold where the drive tells nothing else:
/// walls in the way of the robot go, and things are added.
PriorMap draw_sonar_map(const std::vector<SonarEcho>& echoes, const SurveyedPath& path, const RobotDescription& robot,
                        const std::vector<Eigen::Vector2d>& above = {}, const PriorMap* known = nullptr);

}  // namespace luminav
