#include "services/caretaker/ceiling_changes.hpp"

#include <gmock/gmock.h>

#include <cstdlib>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/caretaker/drawn_visits.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class CeilingChanges : public testing::Test {
 protected:
  void SetUp() override { setenv("TZ", "UTC", 1); }
  void pass(int count, const std::function<FixtureVisit(int, FixtureVisit)>& change) {
    for (int i = 0; i < count; ++i, ++passes_) {
      for (int index = 0; index < 4; ++index) {
        const FixtureVisit visit =
            draw_visit(kMonday + passes_ * kDay + index * 5'000'000, passes_ % 2 == 0, LampFault::kNone, random_);
        ledger_.add(one(index, change(index, visit)), building_.fixtures);
      }
    }
  }
  void see_stranger(int count, const Pose2& place, double length = 1.2, double width = 0.3) {
    for (int i = 0; i < count; ++i) {
      VisitRecorder::Result result;
      result.strangers.push_back({kMonday + i * kDay,
                                  kMonday + i * kDay + 5,
                                  20,
                                  FixtureShape::kRectangle,
                                  {place.x + random_.gauss(0.02), place.y + random_.gauss(0.02), place.theta},
                                  length,
                                  width});
      ledger_.add(result, building_.fixtures);
    }
  }
  static FixtureVisit same(int, const FixtureVisit& visit) { return visit; }

  Building building_ = drawn_building(1, 4);
  LampLedger ledger_{"drawn"};
  SplitMix random_{21};
  int passes_ = 0;
};

TEST_F(CeilingChanges, AreNotProposedForACeilingThatStaysAsItIs) {
  pass(20, same);
  EXPECT_THAT(propose_changes(ledger_, building_), IsEmpty());
}

TEST_F(CeilingChanges, ProposeWhereAMovedFixtureHangs) {
  pass(10, same);
  const auto moved = [](int index, FixtureVisit visit) {
    visit.offset.x += index == 2 ? 0.31 : 0.0;
    return visit;
  };
  pass(kMinChangeVisits - 1, moved);
  EXPECT_THAT(propose_changes(ledger_, building_), IsEmpty());
  pass(2, moved);
  const auto changes = propose_changes(ledger_, building_);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].kind, ChangeKind::kMoved);
  EXPECT_EQ(changes[0].id, 102);
  EXPECT_EQ(changes[0].visits, kMinChangeVisits + 1);
  EXPECT_NEAR(changes[0].fixture.world_from_fixture.x, 4.8 + 0.31, 0.02);
  EXPECT_THAT(describe(changes[0], building_), HasSubstr("fixture 102 is seen (+0.3"));
}

TEST_F(CeilingChanges, ProposeAFixtureThatWasTurnedByARightAngle) {
  pass(10, same);
  int turn = 0;
  pass(kMinChangeVisits, [&](int index, FixtureVisit visit) {
    visit.offset.theta = index == 2 ? (++turn % 2 == 0 ? radians(89.5) : radians(-89.5)) : visit.offset.theta;
    return visit;  // a bar turned to the left looks like one turned to the right
  });
  const auto changes = propose_changes(ledger_, building_);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].id, 102);
  EXPECT_NEAR(std::abs(changes[0].fixture.world_from_fixture.theta), 0.5 * kPi, radians(1.0));
}

TEST_F(CeilingChanges, ProposeItAlsoWhenItPullsThePoseAlongNowAndThen) {
  pass(10, same);
  int turn = 0;
  pass(14, [&](int index, FixtureVisit visit) {
    visit.offset.x += index == 2 && ++turn % 5 < 3 ? 0.31 : 0.0;
    visit.offset.x -= index == 1 && turn % 5 == 4 ? 0.31 : 0.0;  // its neighbour then looks moved
    return visit;
  });
  const auto changes = propose_changes(ledger_, building_);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].id, 102);
}

TEST_F(CeilingChanges, ForgetAFixtureThatIsSeenAtItsPlaceAgain) {
  pass(6, [](int index, FixtureVisit visit) {
    visit.offset.x += index == 2 ? 0.31 : 0.0;
    return visit;
  });
  pass(8, same);
  EXPECT_THAT(propose_changes(ledger_, building_), IsEmpty());
}

TEST_F(CeilingChanges, ProposeNothingForOneVisitBesideItsPlaceAndOthersHalfThere) {
  int turn = 0;
  pass(20, [&](int index, FixtureVisit visit) {
    if (index == 2) {
      visit.offset = {++turn % 10 == 0 ? 0.11 : 0.05, 0.0, 0.0};
    }
    return visit;
  });
  EXPECT_THAT(propose_changes(ledger_, building_), IsEmpty());
}

TEST_F(CeilingChanges, ProposeNothingForOffsetsThatDoNotAgree) {
  pass(10, same);
  int turn = 0;
  pass(10, [&](int index, FixtureVisit visit) {
    visit.offset.x += index == 2 ? (++turn % 2 == 0 ? 0.3 : -0.3) : 0.0;
    return visit;
  });
  EXPECT_THAT(propose_changes(ledger_, building_), IsEmpty());
}

TEST_F(CeilingChanges, ProposeToRemoveWhatIsNotSeenInLightThatShowsIt) {
  pass(10, same);
  const auto gone = [](int index, FixtureVisit visit) {
    if (index == 0) {
      visit.lit = visit.half = visit.unlit = visit.changes = 0;
    }
    return visit;
  };
  pass(kMinChangeVisits, gone);
  const auto changes = propose_changes(ledger_, building_);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].kind, ChangeKind::kRemoved);
  EXPECT_EQ(changes[0].id, 100);
}

TEST_F(CeilingChanges, DoNotRemoveWhatIsTooDarkToSee) {
  pass(10, same);
  pass(10, [](int index, FixtureVisit visit) {
    if (index == 0) {
      visit.lit = visit.half = visit.unlit = visit.changes = 0;
      visit.grey = 20.0;
    }
    return visit;
  });
  EXPECT_THAT(propose_changes(ledger_, building_), IsEmpty());
}

TEST_F(CeilingChanges, ProposeANewFixtureOfAKnownKind) {
  pass(5, same);
  see_stranger(kMinChangeVisits, {3.0, 3.0, 1.0});
  see_stranger(kMinChangeVisits, {6.0, 3.0, 1.0}, 0.5, 0.5);  // of no kind
  const auto changes = propose_changes(ledger_, building_);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].kind, ChangeKind::kNew);
  EXPECT_EQ(changes[0].id, 104);
  EXPECT_NEAR(changes[0].fixture.world_from_fixture.y, 3.0, 0.03);
}

TEST_F(CeilingChanges, ProposeANewFixtureThatLooksWiderAsBurningLampsDo) {
  pass(5, same);
  building_.fixtures[0].width = 0.15;
  see_stranger(kMinChangeVisits, {3.0, 3.0, 1.0}, 1.2, 0.2);
  const auto changes = propose_changes(ledger_, building_);
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_DOUBLE_EQ(changes[0].fixture.width, 0.15);
}

TEST_F(CeilingChanges, DoNotTakeAListedElementForAFixture) {
  building_.elements.push_back({ElementKind::kVent, {3.0, 3.0, 0.0}, 1.2, 0.3});
  see_stranger(10, {3.0, 3.0, 1.0});
  EXPECT_THAT(propose_changes(ledger_, building_), IsEmpty());
}

TEST_F(CeilingChanges, RefusedOnesAreKept) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "refused.json";
  EXPECT_THAT(load_refusals(file), IsEmpty());
  see_stranger(kMinChangeVisits, {3.0, 3.0, 1.0});
  const auto changes = propose_changes(ledger_, building_);
  save_refusals(file, changes);
  const auto refusals = load_refusals(file);
  ASSERT_THAT(refusals, SizeIs(1));
  EXPECT_TRUE(is_same(changes[0], refusals[0]));
  CeilingChange elsewhere = changes[0];
  elsewhere.fixture.world_from_fixture.x += 1.0;
  EXPECT_FALSE(is_same(elsewhere, refusals[0]));
  write_whole_file(file, "[1]");
  EXPECT_THROW((void)load_refusals(file), std::runtime_error);
}

}  // namespace
}  // namespace luminav
