#pragma once

#include <optional>
#include <vector>

#include "services/surveyor/drive/sonar_map.hpp"
#include "services/surveyor/live/live_survey.hpp"

namespace luminav {

/// Where the robot is while it surveys, and the floor as its sonars see it: the last estimate, carried on by odometry
/// as the wheels were found to be. The map is drawn on as the robot drives, and anew along the path that an estimate
/// has put right, so that it does not smear where a loop closes.
class LiveGround {
 public:
  explicit LiveGround(const SurveyModel& model);

  /// The drive has grown by a reading or an echo.
  void add(const OdometryReading& reading);
  void add(const SonarEcho& echo);
  /// A new estimate; `log` is the drive as it is now.
  void take(LiveEstimate& estimate, const SurveyLog& log);
  /// Draws the map anew along the path as it is.
  void redraw(const SurveyLog& log);

  /// Of the last reading; nothing where odometry began anew or the estimate does not know where the drive ended.
  [[nodiscard]] const std::optional<SurveyedPath::Stop>& here() const { return here_; }
  /// [m] driven since the last estimate, or since the drive began.
  [[nodiscard]] double since_estimate() const { return since_estimate_; }
  [[nodiscard]] SonarMap& map() { return map_; }
  [[nodiscard]] const SonarMap& map() const { return map_; }
  /// Counts up when the map is drawn anew: its grid may be another.
  [[nodiscard]] int drawing() const { return drawing_; }
  /// The robot comes near the border of the grid.
  [[nodiscard]] bool is_narrow() const;
  /// Where the robot was [m, world] when images were taken that the survey has looked at.
  [[nodiscard]] std::vector<Eigen::Vector2d> looks(const std::vector<SightingFrame>& frames) const;

 private:
  void go_on(const OdometryReading& reading);

  SurveyModel model_;
  WheelCorrection wheels_;
  std::vector<SurveyedPath::Stop> stops_;  // the path so far
  std::optional<OdometryReading> last_;
  std::optional<SurveyedPath::Stop> here_;
  double since_estimate_ = 0.0;
  SonarMap map_;
  int drawing_ = 1;
};

/// The path of an estimate, and what the sonars heard along it.
void draw(LiveEstimate& estimate, const SurveyLog& log, const SurveyModel& model);

}  // namespace luminav
