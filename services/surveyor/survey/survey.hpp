#pragma once

#include <string>
#include <vector>

#include "services/surveyor/survey/fixture_judgement.hpp"
#include "services/surveyor/survey/loop_closing.hpp"
#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

/// What a drive told of the ceiling.
struct Survey {
  std::vector<KeyFrame> frames;  // of the parts that are on the map
  std::vector<FixturePass> passes;
  SurveyEstimate estimate;              // straight, the longer side along x; or in the frame of the known building
  std::vector<JudgedFixture> fixtures;  // in the estimate's order
  std::vector<JudgedFixture> dropped;   // likewise
  std::vector<ClosureDoubt> doubts;
  double regularity = 0.0;            // 0..1 how far the fixtures hang at right angles
  bool is_placed = false;             // on the known building, in whose frame it then is
  double distance = 0.0;              // [m] driven on this map
  int joined_parts = 0;               // of the drive, beside the longest
  double left_out = 0.0;              // [m] driven in parts of which nobody knows where they lie
  std::vector<double> excess_length;  // fraction by which each kind looks longer than the file says
};

/// Makes a map of fixtures from a drive. Throws std::runtime_error, with one plain sentence, for a drive that says
/// nothing: no odometry, no images, no fixture of any kind. One that cannot be placed on the known building gets a map
/// of its own. Cost: seconds for a drive of 600 m.
Survey survey_drive(const SurveyDrive& drive, const SurveyModel& model);

}  // namespace luminav
