#pragma once

#include <vector>

#include "services/localizer/model/pose_belief.hpp"
#include "services/surveyor/live/live_survey.hpp"

namespace luminav {

/// Where the robot is between two estimates of a survey: the last one carried on by odometry, corrected by the fixtures
/// that it knows well. Small gates, and nothing where two could be meant: what is new is for the next estimate.
class LiveTracker {
 public:
  explicit LiveTracker(const SurveyModel& model) : model_(model) { begin(Pose2{}); }

  /// Begins at a pose, without fixtures.
  void begin(const Pose2& world_from_robot);
  /// Begins where an estimate ends, with its fixtures and wheels.
  void begin(const LiveEstimate& estimate);
  /// Moves on by a step of odometry.
  void drive(const OdometryReading& before, const OdometryReading& now);
  /// Takes an image from where the robot was before it moved by `since`.
  void look(const SightingFrame& frame, const Pose2& since, double linear, double angular);

  [[nodiscard]] const PoseBelief& belief() const { return belief_; }
  /// [m] driven since it began.
  [[nodiscard]] double driven() const { return driven_; }

 private:
  [[nodiscard]] bool correct(const FixtureSighting& sighting, double linear, double angular, PoseBelief& belief) const;

  SurveyModel model_;
  WheelCorrection wheels_;
  std::vector<Fixture> fixtures_;
  PoseBelief belief_;
  double driven_ = 0.0;  // [m]
};

}  // namespace luminav
