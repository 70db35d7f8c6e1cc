#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

enum class Judgement {
  kFixture,     // hangs there
  kSeldomSeen,  // seen too seldom for how often it ought to have been
  kOverlaps     // there hangs another one, seen more often
};

/// A fixture of an estimate, and how sure it is.
struct JudgedFixture {
  Judgement judgement = Judgement::kFixture;
  int seen = 0;             // key frames
  int expected = 0;         // key frames that had all of it in view
  bool has_burned = false;  // seen lit, or half so
  double moved = 0.0;       // [m] from where the known building has it
  // 1-sigma beside the place of the whole map, which nobody knows
  double sigma_along = 0.0;                              // [m] largest
  double sigma_across = 0.0;                             // [m] smallest
  double sigma_heading = 0.0;                            // [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of (x, y, theta), likewise
};

/// Judges each fixture by how often it was seen beside how often it was in view, and by those that it overlaps.
/// What the known building has is believed.
std::vector<JudgedFixture> judge_fixtures(const SurveyEstimate& estimate, const std::vector<KeyFrame>& frames,
                                          const std::vector<FixturePass>& passes, const SurveyModel& model);

/// Fills in the uncertainties, from the joint covariance of all fixtures relative to the first pose: what a rigid
/// motion of the whole map explains is taken out.
void add_uncertainty(std::vector<JudgedFixture>& judged, const SurveyEstimate& estimate,
                     const Eigen::MatrixXd& covariance);

}  // namespace luminav
