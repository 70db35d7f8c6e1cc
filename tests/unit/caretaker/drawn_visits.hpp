#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "services/caretaker/lamp_ledger.hpp"
#include "services/common/building/building.hpp"
#include "services/common/geometry/split_mix.hpp"

namespace luminav {

inline constexpr std::int64_t kMinute = 60'000'000;  // [us]
inline constexpr std::int64_t kDay = 24 * 60 * kMinute;
inline constexpr std::int64_t kMonday = 20'000 * kDay;

enum class LampFault { kNone, kDead, kHalf, kFlickers };

/// Rooms in a row, 8 m apart, each with a row of fixtures 2.4 m apart.
inline Building drawn_building(int rooms, int fixtures) {
  Building building;
  building.name = "drawn";
  for (int room = 0; room < rooms; ++room) {
    for (int i = 0; i < fixtures; ++i) {
      Fixture fixture;
      fixture.id = 100 * (room + 1) + i;
      fixture.world_from_fixture = {2.4 * i, 8.0 * room, 0.0};
      building.fixtures.push_back(fixture);
    }
    building.places.push_back({"room " + std::to_string(room + 1), {0.0, 8.0 * room, 0.0}, false});
  }
  return building;
}

/// A visit as a detector that errs now and then would have it.
inline FixtureVisit draw_visit(std::int64_t begin, bool is_on, LampFault fault, SplitMix& random) {
  FixtureVisit visit;
  visit.begin = begin;
  visit.expected = 12 + static_cast<int>(28.0 * random.uniform());
  visit.end = begin + visit.expected * 100'000;
  visit.grey = is_on ? 90.0 : 60.0;
  bool was_burning = false;
  for (int image = 0; image < visit.expected; ++image) {
    const bool burns = is_on && fault != LampFault::kDead && (fault != LampFault::kFlickers || random.uniform() < 0.6);
    const double draw = random.uniform();
    int state = 0;
    if (burns) {
      state = draw < 0.03 ? 0 : draw < 0.04 ? -1 : 1;
    } else {
      state = draw < 0.38 ? 0 : draw < 0.40 ? 1 : -1;
    }
    const bool is_half = state == 1 && (fault == LampFault::kHalf ? random.uniform() < 0.85 : random.uniform() < 0.02);
    visit.lit += state == 1 && !is_half ? 1 : 0;
    visit.half += is_half ? 1 : 0;
    visit.unlit += state == -1 ? 1 : 0;
    visit.changes += image > 0 && (state == 1) != was_burning ? 1 : 0;
    was_burning = state == 1;
  }
  visit.offset = {random.gauss(0.015), random.gauss(0.015), random.gauss(0.01)};
  return visit;
}

inline VisitRecorder::Result one(int index, const FixtureVisit& visit) {
  VisitRecorder::Result result;
  result.fixtures.emplace_back(index, visit);
  return result;
}

}  // namespace luminav
