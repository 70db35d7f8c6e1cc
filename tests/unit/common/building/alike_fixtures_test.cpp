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

}  // namespace
}  // namespace luminav
