#include "services/caretaker/lamp_ledger.hpp"

#include <gmock/gmock.h>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/caretaker/drawn_visits.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

LampLedger sample(const Building& building) {
  SplitMix random(3);
  LampLedger ledger(building.name);
  ledger.add(one(1, draw_visit(kMonday, true, LampFault::kNone, random)), building.fixtures);
  VisitRecorder::Result strangers;
  strangers.strangers.push_back({kMonday, kMonday + 5, 7, FixtureShape::kSquare, {1.5, 2.5, 0.25}, 0.6, 0.6});
  ledger.add(strangers, building.fixtures);
  return ledger;
}

TEST(LampLedger, ReadsWhatItWrote) {
  const Building building = drawn_building(1, 3);
  const LampLedger ledger = sample(building);
  const LampLedger copy = LampLedger::from_json(ledger.to_json());
  EXPECT_EQ(copy.to_json(), ledger.to_json());
  ASSERT_EQ(copy.visits(101).size(), 1U);
  EXPECT_EQ(copy.visits(101)[0].expected, ledger.visits(101)[0].expected);
  ASSERT_EQ(copy.strangers().size(), 1U);
  EXPECT_DOUBLE_EQ(copy.strangers()[0].world_from_fixture.theta, 0.25);
  EXPECT_EQ(copy.newest(), ledger.visits(101)[0].end);
}

TEST(LampLedger, KeepsTheNewestVisits) {
  const Building building = drawn_building(1, 1);
  SplitMix random(1);
  LampLedger ledger(building.name);
  for (int i = 0; i < 200; ++i) {
    ledger.add(one(0, draw_visit(kMonday + i * kMinute, true, LampFault::kNone, random)), building.fixtures);
  }
  EXPECT_LE(ledger.visits(100).size(), 100U);
  EXPECT_EQ(ledger.visits(100).back().begin, kMonday + 199 * kMinute);
}

TEST(LampLedger, OfAnotherBuildingIsBegunAnew) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "robot" / "ceiling.json";
  save_ledger(file, sample(drawn_building(1, 3)));
  EXPECT_EQ(load_ledger(file, "drawn").size(), 1U);
  EXPECT_EQ(load_ledger(file, "office").size(), 0U);
  EXPECT_EQ(load_ledger(folder.path() / "none.json", "office").size(), 0U);
}

TEST(LampLedger, SaysWhatFileIsDamaged) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "ceiling.json";
  for (const char* text : {"", "{", "[]", "{\"building\": 3}", "{\"building\": \"drawn\", \"newest\": 1}"}) {
    write_whole_file(file, text);
    EXPECT_THAT([&] { (void)load_ledger(file, "drawn"); },
                ThrowsMessage<std::runtime_error>(HasSubstr("ceiling.json: not a ledger of lamps")))
        << text;
  }
}

}  // namespace
}  // namespace luminav
