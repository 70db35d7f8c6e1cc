#include "services/caretaker/lamp_report.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/unit/caretaker/drawn_visits.hpp"

namespace luminav {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Thirty passes below a room of four lamps; the second fails with the 20th.
LampLedger thirty_passes(const Building& building, LampFault fault, bool is_switched) {
  SplitMix random(11);
  LampLedger ledger(building.name);
  for (int pass = 0; pass < 30; ++pass) {
    for (int index = 0; index < 4; ++index) {
      const bool is_on = !is_switched || pass % 3 != 0;
      const bool has_failed = index == 1 && pass >= 20;
      ledger.add(one(index, draw_visit(kMonday + pass * kDay + index * 5'000'000, is_on,
                                       has_failed ? fault : LampFault::kNone, random)),
                 building.fixtures);
    }
  }
  return ledger;
}

class LampReport : public testing::Test {
 protected:
  void SetUp() override { setenv("TZ", "UTC", 1); }
  LampFinding second(LampFault fault, bool is_switched = true) {
    return judge_lamps(thirty_passes(building_, fault, is_switched), building_.fixtures)[1];
  }
  Building building_ = drawn_building(1, 4);
};

TEST_F(LampReport, TellsDeadHalfAndFlickeringLampsFromGoodOnes) {
  EXPECT_EQ(second(LampFault::kNone).condition, LampCondition::kGood);
  EXPECT_EQ(second(LampFault::kDead).condition, LampCondition::kDark);
  EXPECT_EQ(second(LampFault::kHalf).condition, LampCondition::kPartlyDark);
  EXPECT_EQ(second(LampFault::kFlickers).condition, LampCondition::kFlickers);
  EXPECT_EQ(second(LampFault::kDead, false).condition, LampCondition::kDark);
}

TEST_F(LampReport, SaysSinceWhenAndWhoseWitnessItHas) {
  const LampFinding finding = second(LampFault::kDead);
  EXPECT_EQ(finding.since, kMonday + 20 * kDay + 5'000'000);
  EXPECT_EQ(describe(finding, building_).rfind("fixture 101 at (2.4, 0.0), 2 m from room 1: dark since", 0), 0U)
      << describe(finding, building_);
  EXPECT_THAT(describe(finding, building_), HasSubstr("while 100, 102, 103 of its switch burnt"));
}

TEST_F(LampReport, DoesNotCallADarkRoomBroken) {
  SplitMix random(5);
  LampLedger ledger = thirty_passes(building_, LampFault::kNone, true);
  for (int pass = 30; pass < 40; ++pass) {
    for (int index = 0; index < 4; ++index) {
      ledger.add(one(index, draw_visit(kMonday + pass * kDay + index * 5'000'000, false, LampFault::kNone, random)),
                 building_.fixtures);
    }
  }
  for (const LampFinding& finding : judge_lamps(ledger, building_.fixtures)) {
    EXPECT_EQ(finding.condition, LampCondition::kGood) << finding.id;
  }
}

TEST_F(LampReport, JudgesNoLampThatNeverBurntOrWasNeverSeen) {
  SplitMix random(5);
  LampLedger ledger(building_.name);
  for (int pass = 0; pass < 10; ++pass) {
    ledger.add(one(0, draw_visit(kMonday + pass * kDay, false, LampFault::kNone, random)), building_.fixtures);
  }
  const auto findings = judge_lamps(ledger, building_.fixtures);
  EXPECT_EQ(findings[0].condition, LampCondition::kUnjudged);
  EXPECT_EQ(findings[1].condition, LampCondition::kUnseen);
}

TEST_F(LampReport, ForgivesALampThatWasReplaced) {
  SplitMix random(5);
  LampLedger ledger = thirty_passes(building_, LampFault::kDead, true);
  ledger.add(one(1, draw_visit(kMonday + 31 * kDay, true, LampFault::kNone, random)), building_.fixtures);
  EXPECT_EQ(judge_lamps(ledger, building_.fixtures)[1].condition, LampCondition::kGood);
}

TEST_F(LampReport, WritesTextPageTableAndJson) {
  building_.places[0].name = "\"A\" <b> & c";
  const auto findings = judge_lamps(thirty_passes(building_, LampFault::kDead, true), building_.fixtures);
  EXPECT_THAT(lamps_text(findings, building_),
              AllOf(HasSubstr("fixture 101"), HasSubstr("4 fixtures: 3 good, 1 dark"), Not(HasSubstr("fixture 100"))));
  EXPECT_THAT(lamps_html(findings, building_), AllOf(HasSubstr("&lt;b&gt; &amp; c"), Not(HasSubstr("<b>"))));
  EXPECT_THAT(lamps_csv(findings, building_), HasSubstr("101,dark,"));
  EXPECT_THAT(lamps_csv(findings, building_), HasSubstr("\"\"A\"\""));
  const auto json = nlohmann::json::parse(lamps_json(findings, building_));
  EXPECT_EQ(json["lamps"].size(), 4U);
  EXPECT_EQ(json["lamps"][1]["condition"], "dark");
}

}  // namespace
}  // namespace luminav
