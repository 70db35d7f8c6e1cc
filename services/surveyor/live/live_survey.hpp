#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "services/surveyor/drive/sonar_map.hpp"
#include "services/surveyor/drive/survey_log.hpp"
#include "services/surveyor/survey/survey.hpp"

namespace luminav {

/// What an estimate made of a drive so far. Its world begins where the drive began, axes along the fixtures, so that
/// the map stays where it is from one estimate to the next.
struct LiveEstimate {
  Survey survey;
  std::vector<std::string> remarks;
  double distance = 0.0;        // [m] of the drive until then
  std::optional<KeyFrame> end;  // where the drive ended then, if that is on the map
  Pose2 world_from_robot;       // there
  std::vector<SurveyedPath::Stop> path;
  std::optional<SonarMap> map;  // along it
};

/// Surveys a drive so far. Throws std::runtime_error as survey_drive does.
LiveEstimate estimate_so_far(const SurveyLog& log, const SurveyModel& model);
/// The same of a survey that was made of the log already.
LiveEstimate live_estimate(Survey survey, const SurveyLog& log, const SurveyModel& model);

/// Distance [m] that odometry tells, between readings of one session.
double driven_distance(const std::vector<OdometryReading>& odometry);

/// A fixture as the growing map has it.
struct LiveFixture {
  int kind = 0;  // index into the kinds
  Pose2 world_from_fixture;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // [m^2] beside the map as a whole
  bool is_provisional = false;                           // seen since the last estimate: placed by odometry alone
  bool is_open = false;                                  // may be one that was seen before
};

struct LivePlace {
  std::string name;
  Eigen::Vector2d position;  // [m] world
};

/// The map as far as the robot was driven.
struct LiveMap {
  double distance = 0.0;            // [m] driven
  double estimated_distance = 0.0;  // [m] of these in the last estimate
  std::optional<Pose2> world_from_robot;
  std::vector<LiveFixture> fixtures;
  std::vector<Eigen::Vector2d> path;  // [m] world
  std::vector<LivePlace> places;
  std::vector<std::string> remarks;
};

/// A survey while it is driven: says when another estimate is worth its cost, and goes on by odometry from the last.
class LiveSurvey {
 public:
  explicit LiveSurvey(const SurveyModel& model) : model_(model) {}

  /// The drive has grown by a reading.
  void add(const OdometryReading& reading);
  [[nodiscard]] double distance() const { return distance_; }

  /// The drive has grown by a fifth, and by ten metres: so all estimates together cost six times the last at most.
  [[nodiscard]] bool is_estimate_due() const;
  /// While the robot finds its way by the map it draws, by a tenth and by ten metres.
  void set_exploring(bool is_exploring) { is_exploring_ = is_exploring; }
  /// An estimate of the drive as it is now has begun.
  void begin_estimate() { begun_at_ = distance_; }
  void take(LiveEstimate estimate) { estimate_ = std::move(estimate); }

  /// `log` is the drive so far. Cost: grows with what was driven since the last estimate.
  [[nodiscard]] LiveMap map(const SurveyLog& log) const;

 private:
  /// The part of the path behind the last estimate.
  struct Tail {
    std::vector<KeyFrame> frames;
    std::vector<Pose2> poses;
    std::vector<FixturePass> passes;
  };
  [[nodiscard]] Tail tail_of(const SurveyLog& log) const;
  void add_estimate(LiveMap& map) const;
  void add_tail(const Tail& tail, LiveMap& map) const;

  SurveyModel model_;
  std::optional<OdometryReading> last_;
  double distance_ = 0.0;  // [m]
  double begun_at_ = 0.0;  // [m] distance when the last estimate began
  bool is_exploring_ = false;
  std::optional<LiveEstimate> estimate_;
};

}  // namespace luminav
