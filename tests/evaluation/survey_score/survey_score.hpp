#pragma once

#include <string>
#include <vector>

#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// A fixture of a survey, as its building and its JSON report have it.
struct ScoredFixture {
  Fixture fixture;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of (x, y, theta), beside the place of the whole map
};

/// How a surveyed building compares with the true one.
struct SurveyScore {
  int driven_under = 0;             // true fixtures that were wholly in view for at least kMinLook of driving
  int found = 0;                    // of these
  int doubled = 0;                  // surveyed ones beside another one of the same true fixture
  int alike = 0;                    // surveyed ones where a vent, or the like, of the same size hangs
  int invented = 0;                 // where nothing hangs
  double position_rms = 0.0;        // [m] after the rigid motion that fits best
  double heading_rms = 0.0;         // [rad]
  double worst = 0.0;               // [m]
  double scale = 0.0;               // fraction by which the survey is too large
  double normalised_squared = 0.0;  // mean over fixtures of the position's squared error by its covariance, over 2
  Pose2 truth_from_survey;
};

/// Compares fixtures of a survey with those of the world. `truth_from_survey` says roughly how the maps lie, to half
/// the spacing of the fixtures; `path` holds the true poses of the robot, a few centimetres apart.
SurveyScore score_survey(const std::vector<ScoredFixture>& surveyed, const WorldTruth& world,
                         const std::vector<Pose2>& path, const Pose2& truth_from_survey);

/// One line for a person.
std::string to_text(const SurveyScore& score);

/// The figures as JSON text: metres, degrees.
std::string to_json(const SurveyScore& score);

}  // namespace luminav
