#include "services/common/building/alike_fixtures.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

/// A row of equal fixtures along x, a pitch apart.
Building row_of(int count, double pitch) {
  Building building;
  for (int i = 0; i < count; ++i) {
    building.fixtures.push_back({.id = i + 1, .world_from_fixture = {pitch * i, 0.0, 0.0}});
  }
  return building;
}

TEST(AlikeFixtures, AreAllOfALongRowButItsEndsOnlyEachOther) {
  const AlikeFixtures alike = find_alike_fixtures(row_of(10, 3.0));
  EXPECT_EQ(alike.fixtures, 10U);
  EXPECT_EQ(alike.largest_group.size(), 8U);  // those with a neighbour on both sides
}

TEST(AlikeFixtures, AreToldApartByAVentBesideOneOfThem) {
  Building building = row_of(2, 3.0);
  EXPECT_EQ(find_alike_fixtures(building).fixtures, 2U);  // the half turn of the whole row
  building.elements.push_back({.world_from_element = {0.0, 1.0, 0.0}});
  EXPECT_EQ(find_alike_fixtures(building).fixtures, 0U);
}

TEST(AlikeFixtures, AreToldApartByKindAndSize) {
  Building building = row_of(2, 20.0);
  EXPECT_EQ(find_alike_fixtures(building).fixtures, 2U);
  building.fixtures[1].width = 0.15;
  EXPECT_EQ(find_alike_fixtures(building).fixtures, 0U);
}

TEST(AlikeFixtures, DoNotDependOnWhereTheBuildingStands) {
  Building building = row_of(6, 2.5);
  building.fixtures[4].world_from_fixture.y = 0.4;
  const AlikeFixtures before = find_alike_fixtures(building);
  for (Fixture& fixture : building.fixtures) {
    fixture.world_from_fixture = Pose2{100.0, -30.0, 1.1} * fixture.world_from_fixture;
  }
  EXPECT_EQ(find_alike_fixtures(building).fixtures, before.fixtures);
  EXPECT_EQ(find_alike_fixtures(building).largest_group, before.largest_group);
}

/// Round fixtures of one size.
Building round_ones(const std::vector<Eigen::Vector2d>& places) {
  Building building;
  for (const Eigen::Vector2d& place : places) {
    building.fixtures.push_back({.id = static_cast<int>(building.fixtures.size()) + 1,
                                 .shape = FixtureShape::kRound,
                                 .world_from_fixture = {place.x(), place.y(), 0.0},
                                 .length = 0.2,
                                 .width = 0.2});
  }
  return building;
}

TEST(AlikeFixtures, RoundOnesAreComparedUnderTheTurnThatTheirNeighboursAskFor) {
  // two pairs 2 m apart, the second turned by 37 degrees; a triangle tells itself from them
  const Eigen::Vector2d turned(2.0 * std::cos(radians(37)), 2.0 * std::sin(radians(37)));
  const Eigen::Vector2d far(20.0, 0.0);
  EXPECT_EQ(find_alike_fixtures(round_ones({{0.0, 0.0}, {2.0, 0.0}, far, far + turned})).fixtures, 4U);
  EXPECT_EQ(find_alike_fixtures(round_ones({{0.0, 0.0}, {2.0, 0.0}, far, far + 1.3 * turned})).largest_group.size(), 2U)
      << "the half turn of a pair";
}

TEST(AlikeFixtures, CountsRoundOnesThatNothingGivesAHeading) {
  Building building = round_ones({{0.0, 0.0}, {2.0, 0.0}, {20.0, 0.0}});
  EXPECT_EQ(find_alike_fixtures(building).without_heading, 3U);
  building.elements.push_back({.world_from_element = {20.0, 1.0, 0.0}});
  EXPECT_EQ(find_alike_fixtures(building).without_heading, 2U);
}

}  // namespace
}  // namespace luminav
