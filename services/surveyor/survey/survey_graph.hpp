#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/wheel_correction.hpp"
#include "services/surveyor/known_building.hpp"
#include "services/surveyor/survey/ceiling_kinds.hpp"
#include "services/surveyor/survey/fixture_passes.hpp"
#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {

/// What is known before the drive.
struct SurveyModel {
  RobotDescription robot;
  ErrorParams errors;
  WheelCorrection wheels;  // from a calibration drive, if there was one
  CeilingKinds kinds;
  std::optional<KnownBuilding> known;  // that the survey goes on with
};

/// A fixture as the drive saw it: one or more passes, or none below one that is known.
struct SurveyedFixture {
  int kind = 0;             // index into the kinds
  std::vector<int> passes;  // indices, in the order of the drive
  Pose2 world_from_fixture;
  int known = -1;  // index into the fixtures of the known building; -1 = it is in no file
};

/// All that a survey estimates.
struct SurveyEstimate {
  std::vector<Pose2> poses;  // world_from_robot, of each key frame
  std::vector<SurveyedFixture> fixtures;
  std::vector<SurveyedFixture> dropped;  // seen, and not believed to be fixtures: left as they were
  std::array<double, 3> wheels{};        // scale, ratio, base, as in WheelCorrection
  std::array<double, 6> camera{};        // tilt x, tilt y, yaw, scale, time, lens: beside what the robot's file says
  double direction = 0.0;                // [rad] of the building, modulo a quarter turn; see below
  bool has_converged = false;
};

/// What the known building has, before anything was driven.
SurveyEstimate estimate_of(const KnownBuilding& known);

/// How strongly a building is believed to be what buildings are like; 0 = not at all. What hangs otherwise loses its
/// say (Cauchy), so that the prior sharpens what agrees and drags nothing.
struct BuildingPrior {
  double right_angle = 0.0;  // [rad] 1-sigma of fixtures along the building or across it
  double row = 0.0;          // [m] 1-sigma of neighbours in a row, across it, and of each in the middle of two
};

/// Batch estimate of poses, fixtures, wheels and camera of one part of a drive, with the sightings' and the wheels' own
/// errors, as in a calibration drive but with fixtures that nobody has measured. Known ones keep to their file as
/// surely as it is; without any the first pose stays where it is.
class SurveyGraph {
 public:
  /// Everything is kept by reference.
  SurveyGraph(const SurveyModel& model, const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes);

  /// The estimate nearest to one that is given.
  [[nodiscard]] SurveyEstimate optimise(SurveyEstimate estimate, const BuildingPrior& prior) const;

  /// How far each sighting of each pass is from where the estimate expects it, in deviations.
  [[nodiscard]] std::vector<std::vector<double>> misfits(const SurveyEstimate& estimate) const;

  /// Joint covariance of (x, y, theta) of all fixtures, in their order, relative to the first pose. Cost: about a
  /// second for 300 fixtures and 5,000 key frames.
  [[nodiscard]] Eigen::MatrixXd fixture_covariance(const SurveyEstimate& estimate, const BuildingPrior& prior) const;

 private:
  struct Problem;
  [[nodiscard]] std::unique_ptr<Problem> build(const SurveyEstimate& estimate, const BuildingPrior& prior) const;
  void add_sightings(Problem& problem, const SurveyEstimate& estimate) const;
  void add_odometry(Problem& problem) const;
  void add_building(Problem& problem, const SurveyEstimate& estimate, const BuildingPrior& prior) const;
  void add_priors(Problem& problem) const;
  void add_known(Problem& problem, const SurveyEstimate& estimate) const;

  const SurveyModel& model_;
  const std::vector<KeyFrame>& frames_;
  const std::vector<FixturePass>& passes_;
};

}  // namespace luminav
