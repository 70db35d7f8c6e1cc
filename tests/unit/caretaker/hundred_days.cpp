#include "tests/unit/caretaker/hundred_days.hpp"

#include <algorithm>
#include <map>

#include "services/caretaker/ceiling_changes.hpp"
#include "services/caretaker/lamp_report.hpp"
#include "tests/unit/caretaker/drawn_visits.hpp"

namespace luminav {
namespace {

constexpr int kRooms = 5;
constexpr int kLamps = 6;
constexpr int kDays = 100;

struct Failure {
  LampFault fault = LampFault::kNone;
  int day = 0;
};

std::map<int, Failure> draw_failures(const Building& building, SplitMix& random) {
  std::map<int, Failure> failures;
  for (const Fixture& fixture : building.fixtures) {
    if (fixture.id % 100 < kLamps - 2 && random.uniform() < 0.4) {  // some of each room stay good
      const auto fault = static_cast<LampFault>(1 + static_cast<int>(3.0 * random.uniform()));
      failures[fixture.id] = {fault, 10 + static_cast<int>(80.0 * random.uniform())};
    }
  }
  return failures;
}

LampCondition condition_of(LampFault fault) {
  switch (fault) {
    case LampFault::kDead:
      return LampCondition::kDark;
    case LampFault::kHalf:
      return LampCondition::kPartlyDark;
    case LampFault::kFlickers:
      return LampCondition::kFlickers;
    case LampFault::kNone:
      break;
  }
  return LampCondition::kGood;
}

}  // namespace

HundredDays simulate_hundred_days(std::uint64_t seed) {
  SplitMix random(seed);
  const Building building = drawn_building(kRooms, kLamps);
  const std::map<int, Failure> failures = draw_failures(building, random);
  std::map<int, int> shown;  // passes by a failed lamp whose switch was on
  std::set<int> reported;
  HundredDays outcome;
  outcome.failures = static_cast<int>(failures.size());
  LampLedger ledger(building.name);
  for (int pass = 0; pass < 3 * kDays; ++pass) {
    const std::int64_t begin = kMonday + pass / 3 * kDay + (9 + 3 * (pass % 3)) * 60 * kMinute;
    for (int room = 0; room < kRooms; ++room) {
      const bool is_on = room == 0 || random.uniform() < 0.7;  // the first is a corridor
      for (int lamp = 0; lamp < kLamps; ++lamp) {
        const int index = room * kLamps + lamp;
        const int id = building.fixtures[static_cast<std::size_t>(index)].id;
        const auto failure = failures.find(id);
        const bool has_failed = failure != failures.end() && failure->second.day <= pass / 3;
        shown[id] += has_failed && is_on ? 1 : 0;
        ledger.add(one(index, draw_visit(begin + room * 30'000'000 + lamp * 4'000'000, is_on,
                                         has_failed ? failure->second.fault : LampFault::kNone, random)),
                   building.fixtures);
      }
    }
    for (const LampFinding& finding : judge_lamps(ledger, building.fixtures)) {
      const auto failure = failures.find(finding.id);
      const bool is_fault = finding.condition >= LampCondition::kFlickers;
      const bool is_true = failure != failures.end() && failure->second.day <= pass / 3 &&
                           finding.condition == condition_of(failure->second.fault);
      if (is_fault && !is_true) {
        outcome.false_reports.insert(finding.id);
      }
      if (is_fault && is_true && reported.insert(finding.id).second) {
        outcome.late += shown[finding.id] > kMinVisits ? 1 : 0;
        outcome.latest = std::max(outcome.latest, shown[finding.id]);
      }
    }
  }
  outcome.late += static_cast<int>(failures.size() - reported.size());
  outcome.changes = static_cast<int>(propose_changes(ledger, building).size());
  return outcome;
}

}  // namespace luminav
