#include "services/caretaker/fixture_visit.hpp"

#include <gmock/gmock.h>

namespace luminav {
namespace {

FixtureVisit visit(int expected, int lit, int half, int unlit, int changes = 0) {
  FixtureVisit visit;
  visit.expected = expected;
  visit.lit = lit;
  visit.half = half;
  visit.unlit = unlit;
  visit.changes = changes;
  return visit;
}

TEST(FixtureVisit, BurnsWhenMostImagesSayIt) {
  EXPECT_EQ(was_burning(visit(20, 18, 0, 1)), true);
  EXPECT_EQ(was_burning(visit(20, 1, 0, 15)), false);
  EXPECT_EQ(was_burning(visit(20, 0, 0, 0)), false);  // not seen at all: nothing burnt there
  EXPECT_EQ(was_burning(visit(20, 7, 0, 7)), std::nullopt);
}

TEST(FixtureVisit, IsHalfLitWhenMostOfWhatWasSeenIs) {
  EXPECT_TRUE(was_half_lit(visit(20, 3, 14, 0)));
  EXPECT_FALSE(was_half_lit(visit(20, 14, 3, 0)));
  EXPECT_FALSE(was_half_lit(visit(20, 0, 1, 0)));
}

TEST(FixtureVisit, FlickersWhenItGoesOnAndOffAgainAndAgain) {
  EXPECT_TRUE(was_flickering(visit(20, 12, 0, 7, 9)));
  EXPECT_FALSE(was_flickering(visit(20, 10, 0, 10, 1)));  // somebody used the switch
  EXPECT_FALSE(was_flickering(visit(20, 19, 0, 1, 4)));
  EXPECT_FALSE(was_flickering(visit(20, 12, 0, 0, 9)));  // not found by the detector now and then
}

}  // namespace
}  // namespace luminav
