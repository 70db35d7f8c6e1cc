#include "services/caretaker/shared_switches.hpp"

#include <gmock/gmock.h>

#include "tests/unit/caretaker/drawn_visits.hpp"

namespace luminav {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

/// Visits to two rooms of three lamps; `is_on` says whether a room's switch is on.
template <typename Switch>
LampLedger visit_rooms(const Building& building, int passes, Switch is_on) {
  SplitMix random(7);
  LampLedger ledger(building.name);
  for (int pass = 0; pass < passes; ++pass) {
    for (int index = 0; index < 6; ++index) {
      ledger.add(one(index, draw_visit(kMonday + pass * kDay + index * 5'000'000, is_on(pass, index), LampFault::kNone,
                                       random)),
                 building.fixtures);
    }
  }
  return ledger;
}

TEST(SharedSwitches, AreLearntFromWhatGoesOnAndOffTogether) {
  const Building building = drawn_building(2, 3);
  const LampLedger ledger =
      visit_rooms(building, 12, [](int pass, int index) { return (index < 3 ? pass % 2 : pass / 2 % 2) == 0; });
  EXPECT_THAT(switch_partners(ledger, building.fixtures, 100, kMonday + 12 * kDay), UnorderedElementsAre(101, 102));
  EXPECT_THAT(switch_partners(ledger, building.fixtures, 202, kMonday + 12 * kDay), UnorderedElementsAre(200, 201));
}

TEST(SharedSwitches, AreNotClaimedAfterOneVisit) {
  const Building building = drawn_building(2, 3);
  const LampLedger ledger = visit_rooms(building, 1, [](int, int) { return true; });
  EXPECT_THAT(switch_partners(ledger, building.fixtures, 100, kMonday + kDay), IsEmpty());
}

TEST(SharedSwitches, OfNeighboursAreNotSharedWhenOneIsOftenDarkAlone) {
  const Building building = drawn_building(2, 3);
  const LampLedger ledger = visit_rooms(building, 20, [](int pass, int index) { return index != 1 || pass % 3 == 0; });
  EXPECT_THAT(switch_partners(ledger, building.fixtures, 100, kMonday + 20 * kDay), Not(Contains(101)));
}

TEST(SharedSwitches, AreJudgedByWhatWasSeenBefore) {
  const Building building = drawn_building(2, 3);
  const LampLedger ledger = visit_rooms(building, 30, [](int pass, int index) { return index != 1 || pass < 20; });
  EXPECT_THAT(switch_partners(ledger, building.fixtures, 101, kMonday + 20 * kDay), Contains(100));
}

TEST(SharedSwitches, OfAFixtureThatIsNotInTheFileAreNone) {
  const Building building = drawn_building(2, 3);
  EXPECT_THAT(switch_partners(LampLedger("drawn"), building.fixtures, 7, kMonday), IsEmpty());
}

}  // namespace
}  // namespace luminav
