#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/caretaker/lamp_ledger.hpp"
#include "services/common/building/building.hpp"

namespace luminav {

enum class LampCondition {
  kUnseen,    // no visit, or none since long
  kGood,      // burns when the others of its switch do
  kUnjudged,  // is dark, and which lamps share its switch is not known
  kFlickers,
  kPartlyDark,  // one of its lamps
  kDark
};

/// As reports spell it.
const char* name_of(LampCondition condition);

/// What is to be said of one fixture.
struct LampFinding {
  int id = 0;
  LampCondition condition = LampCondition::kUnseen;
  std::int64_t since = 0;     // [us] the first visit that showed it so; of a good one the last visit
  int visits = 0;             // that speak for it
  std::vector<int> partners;  // ids of those of its switch that burnt meanwhile
};

/// Judges each fixture, in the order of the building's file. A lamp counts as dark only if it was dark in `kMinVisits`
/// visits while one of its switch burnt.
std::vector<LampFinding> judge_lamps(const LampLedger& ledger, const std::vector<Fixture>& fixtures);

inline constexpr int kMinVisits = 3;  // that agree

/// "17 near lift: dark since Tue 24 Nov, 14:05; 4 visits, while 16 and 18 burnt". Times in the local zone.
std::string describe(const LampFinding& finding, const Building& building);

/// Reports on all fixtures: one line each, as text with faults only, as a page, as CSV and as JSON.
std::string lamps_text(const std::vector<LampFinding>& findings, const Building& building);
std::string lamps_html(const std::vector<LampFinding>& findings, const Building& building);
std::string lamps_csv(const std::vector<LampFinding>& findings, const Building& building);
std::string lamps_json(const std::vector<LampFinding>& findings, const Building& building);

}  // namespace luminav
