#include "services/surveyor/survey/fixture_rows.hpp"

#include <gtest/gtest.h>

#include "services/surveyor/survey/straightening.hpp"

namespace luminav {
namespace {

/// Two rows of four at a pitch of 2.5 m and 3 m apart, and one fixture that hangs between them.
SurveyEstimate two_rows() {
  SurveyEstimate estimate;
  for (int i = 0; i < 8; ++i) {
    estimate.fixtures.push_back({0, {i}, {2.5 * (i % 4), 3.0 * (i / 4), 0.0}});
  }
  estimate.fixtures.push_back({0, {8}, {1.2, 1.4, 0.0}});
  return estimate;
}

TEST(FixtureRows, AreFoundAlongAndAcross) {
  const FixtureRows rows = find_rows(two_rows());
  EXPECT_EQ(rows.pairs.size(), 10u);   // three in each row, four between them
  EXPECT_EQ(rows.triples.size(), 4u);  // two in each row
  for (const RowPair& pair : rows.pairs) {
    EXPECT_NE(pair.first, 8);
    EXPECT_NE(pair.second, 8);
  }
}

TEST(FixtureRows, TurnWithTheBuilding) {
  SurveyEstimate estimate = two_rows();
  transform(estimate, {1.0, -2.0, 0.4});
  EXPECT_EQ(find_rows(estimate).pairs.size(), 10u);
}

TEST(FixtureRows, JoinNoOtherKindAndNoUnevenSpacing) {
  SurveyEstimate estimate = two_rows();
  estimate.fixtures[1].kind = 1;
  EXPECT_EQ(find_rows(estimate).pairs.size(), 7u);  // neither along nor across; the two beside it are 5 m apart
  estimate = two_rows();
  estimate.fixtures[3].world_from_fixture.x += 0.5;
  EXPECT_EQ(find_rows(estimate).triples.size(), 3u);
}

}  // namespace
}  // namespace luminav
