#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "services/common/ceiling/odometry_history.hpp"
#include "services/surveyor/drive/sonar_map.hpp"
#include "services/surveyor/live/live_survey.hpp"
#include "services/surveyor/live/live_tracker.hpp"

namespace luminav {

/// Where the robot is while it surveys, and the floor as its sonars see it: the last estimate, carried on by odometry
/// and by the fixtures that are on the map. The map is drawn on as the robot drives, and anew along the path that an
/// estimate has put right, so that it does not smear where a loop closes.
class LiveGround {
 public:
  explicit LiveGround(const SurveyModel& model);

  /// The drive has grown by a reading, an echo or an image.
  void add(const OdometryReading& reading);
  void add(const SonarEcho& echo);
  void add(const SightingFrame& frame);
  /// A new estimate; `log` is the drive as it is now.
  void take(LiveEstimate& estimate, const SurveyLog& log);
  /// Draws the map anew along the path as it is.
  void redraw(const SurveyLog& log);

  /// Of the last reading; nothing where odometry began anew or the estimate does not know where the drive ended.
  [[nodiscard]] const std::optional<SurveyedPath::Stop>& here() const { return here_; }
  /// How surely.
  [[nodiscard]] const Eigen::Matrix3d& covariance() const { return tracker_.belief().covariance; }
  /// [m] driven since the last estimate that knows where the drive ended, or since the drive began.
  [[nodiscard]] double since_estimate() const { return tracker_.driven(); }
  [[nodiscard]] SonarMap& map() { return map_; }
  [[nodiscard]] const SonarMap& map() const { return map_; }
  /// Counts up when the map is drawn anew: its grid may be another.
  [[nodiscard]] int drawing() const { return drawing_; }
  /// The robot comes near the border of the grid.
  [[nodiscard]] bool is_narrow() const;
  /// Where the robot was [m, world] when images were taken that the survey has looked at, of those close together one.
  [[nodiscard]] std::vector<Eigen::Vector2d> looks(const std::vector<SightingFrame>& frames) const;

 private:
  void go_on(const OdometryReading& reading);
  void look();

  SurveyModel model_;
  LiveTracker tracker_;
  std::vector<SurveyedPath::Stop> stops_;  // the path so far
  OdometryHistory history_;
  std::deque<SightingFrame> waiting_;  // images that are newer than the last reading
  std::optional<SurveyedPath::Stop> here_;
  SonarMap map_;
  int drawing_ = 1;
};

/// The path of an estimate, and what the sonars heard along it.
void draw(LiveEstimate& estimate, const SurveyLog& log, const SurveyModel& model);

}  // namespace luminav
