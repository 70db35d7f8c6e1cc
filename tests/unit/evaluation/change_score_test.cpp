#include "tests/evaluation/changes_score/change_score.hpp"

#include <gmock/gmock.h>

#include "tests/unit/caretaker/drawn_visits.hpp"

namespace luminav {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

/// Passes all fixtures of a room once a day; one of them is seen beside its place.
void pass(LampLedger& ledger, const Building& told, int day, std::size_t moved, const Pose2& offset) {
  SplitMix random(static_cast<std::uint64_t>(day));
  for (std::size_t i = 0; i < told.fixtures.size(); ++i) {
    FixtureVisit visit = draw_visit(kMonday + day * kDay, true, LampFault::kNone, random);
    visit.offset = i == moved ? offset : visit.offset;
    ledger.add(one(static_cast<int>(i), visit), told.fixtures);
  }
}

TEST(ChangeScore, FindsWhatWasMovedRemovedAndAdded) {
  const Building told = drawn_building(1, 4);
  Building truth = told;
  truth.fixtures[0].world_from_fixture.x += 0.3;
  truth.fixtures[1].id = 900;
  const ChangeScore score(told, truth);
  ASSERT_THAT(score.changes(), SizeIs(3));
  EXPECT_EQ(score.changes()[0].change.kind, ChangeKind::kMoved);
  EXPECT_EQ(score.changes()[1].change.kind, ChangeKind::kRemoved);
  EXPECT_EQ(score.changes()[2].change.kind, ChangeKind::kNew);
  EXPECT_THAT(ChangeScore(told, told).changes(), IsEmpty());
}

TEST(ChangeScore, CountsThePassesUntilAProposalAndTellsFalseOnes) {
  const Building told = drawn_building(1, 4);
  Building truth = told;
  truth.fixtures[2].world_from_fixture.x += 0.3;
  ChangeScore score(told, truth);
  ChangeScore of_unchanged(told, told);
  LampLedger ledger(told.name);
  for (int day = 0; day < 8; ++day) {
    pass(ledger, told, day, 2, {0.31, 0.0, 0.0});
    score.look(ledger);
    of_unchanged.look(ledger);
  }
  EXPECT_TRUE(score.changes()[0].is_proposed);
  EXPECT_EQ(score.changes()[0].passes, kMinChangeVisits);
  EXPECT_NEAR(score.changes()[0].offset, 0.01, 0.001);
  EXPECT_THAT(score.false_proposals(), IsEmpty());
  EXPECT_THAT(of_unchanged.false_proposals(), SizeIs(1));  // once, however often
}

}  // namespace
}  // namespace luminav
