#pragma once

#include <cstdint>
#include <vector>

#include "services/caretaker/lamp_ledger.hpp"
#include "services/common/building/building.hpp"

namespace luminav {

/// Two visits so near in time that nobody used the switch between them, most likely.
bool are_together(const FixtureVisit& a, const FixtureVisit& b);

/// Ids of the fixtures that burn and go dark with fixture `id`, as far as visits before `until` [us] tell: the odds
/// are above 50 to 1. Neighbours are likely to, others unlikely; each pair of visits together says more. Without
/// knowing when somebody uses the switch, lamps that always burn tell little, and lamps that went dark together much.
std::vector<int> switch_partners(const LampLedger& ledger, const std::vector<Fixture>& fixtures, int id,
                                 std::int64_t until);

}  // namespace luminav
