#pragma once

#include <vector>

#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

/// Two fixtures of one kind that hang in line, one behind or beside the other.
struct RowPair {
  int first = 0;  // index into the estimate's fixtures
  int second = 0;
  int quarter_turns = 0;  // 0: the row runs along the building's direction, 1: across it
};

/// Three neighbours of a row, evenly spaced.
struct RowTriple {
  int before = 0;
  int middle = 0;
  int behind = 0;
  int quarter_turns = 0;
};

struct FixtureRows {
  std::vector<RowPair> pairs;
  std::vector<RowTriple> triples;
};

/// Rows along and across `estimate.direction`, as an electrician hangs them: each fixture with its nearest neighbour in
/// line to either side.
FixtureRows find_rows(const SurveyEstimate& estimate);

}  // namespace luminav
