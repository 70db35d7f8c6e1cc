#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/caretaker/lamp_ledger.hpp"
#include "services/common/building/building.hpp"

namespace luminav {

enum class ChangeKind { kMoved, kRemoved, kNew };

/// As files and reports spell it.
const char* name_of(ChangeKind kind);

/// What the building's file should say otherwise, by what was seen visit after visit. Nothing changes by itself.
struct CeilingChange {
  ChangeKind kind = ChangeKind::kMoved;
  int id = 0;              // of the fixture; of a new one the first free id
  Fixture fixture;         // as it is seen to hang; of a removed one as the file has it
  int visits = 0;          // that say so, the newest of them
  std::int64_t since = 0;  // [us] of the first
  std::int64_t until = 0;  // [us] of the last
};

/// Proposes changes: a fixture that was seen beside its place, one that was not seen in light that would have shown
/// it, and what hangs where the file has nothing; each in `kMinChangeVisits` visits or more. Removed ones after moved
/// ones, new ones last.
std::vector<CeilingChange> propose_changes(const LampLedger& ledger, const Building& building);

inline constexpr int kMinChangeVisits = 4;

/// "fixture 17: hangs 0.31 m east ... of its place, seen in 14 visits from ... to ...". Times in the local zone.
std::string describe(const CeilingChange& change, const Building& building);

/// True when two propose the same, within what seeing it again may shift it.
bool is_same(const CeilingChange& a, const CeilingChange& b);

/// Changes that a person refused, kept in a file beside the ledger.
std::vector<CeilingChange> load_refusals(const std::filesystem::path& file);
void save_refusals(const std::filesystem::path& file, const std::vector<CeilingChange>& refusals);

}  // namespace luminav
