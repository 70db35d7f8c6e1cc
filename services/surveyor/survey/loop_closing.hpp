#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

/// Two fixtures of the estimate that are one.
struct FixturePair {
  int first = 0;  // index into the estimate's fixtures, seen earlier
  int second = 0;
};

/// Two passes below different fixtures.
struct PassPair {
  int first = 0;  // index into the passes, or of_known(): not below that fixture
  int second = 0;
};

/// Stands for a fixture of the known building among passes.
inline int of_known(int known) {
  return -1 - known;
}

/// A fixture that may be one that was seen before, and may not.
struct ClosureDoubt {
  int fixture = 0;
  std::vector<int> candidates;
  double sigma = 0.0;  // [m] largest 1-sigma between them
};

struct LoopClosures {
  std::vector<FixturePair> sure;
  std::vector<ClosureDoubt> doubts;
};

/// Looks for fixtures that are one, by the covariance between them: a pair has to be the only one within the gate, to
/// span less than a share of the spacing of the fixtures, so that the next one in the row is out of question, and
/// others near it on the drive have to shift alike. `banned` are pairs of passes that were tried and found to be of
/// two.
LoopClosures find_closures(const SurveyEstimate& estimate, const Eigen::MatrixXd& covariance,
                           const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes,
                           const CeilingKinds& kinds, const std::vector<PassPair>& banned);

/// The estimate with pairs made one fixture each, which lies where the earlier one did.
SurveyEstimate merge(SurveyEstimate estimate, const std::vector<FixturePair>& pairs);

/// Takes passes out of their fixture that, by the poses they were seen from, belong elsewhere by more than `limit` [m]
/// or `limit_heading` [rad]: each becomes a fixture of its own again, and pairs of it and the others are told.
std::vector<PassPair> split_what_disagrees(SurveyEstimate& estimate, const std::vector<FixturePass>& passes,
                                           const CeilingKinds& kinds, double limit = 0.15,
                                           double limit_heading = radians(5.0));

}  // namespace luminav
