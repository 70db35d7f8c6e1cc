#include "services/detector/outline/ceiling_catalogue.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(CeilingCatalogue, CountsFixturesOfAKindWhicheverWayTheyLie) {
  Building building;
  for (const Eigen::Vector2d& size :
       {Eigen::Vector2d(1.2, 0.3), Eigen::Vector2d(1.2, 0.15), Eigen::Vector2d(0.3, 1.2)}) {
    Fixture fixture;
    fixture.length = size.x();
    fixture.width = size.y();
    building.fixtures.push_back(fixture);
  }
  const CeilingCatalogue catalogue = catalogue_of(building);
  ASSERT_EQ(catalogue.fixtures.size(), 2U);
  EXPECT_EQ(catalogue.fixtures[0].width, 0.3);
  EXPECT_EQ(catalogue.fixtures[0].count, 2);
  EXPECT_EQ(catalogue.fixtures[1].count, 1);
}

}  // namespace
}  // namespace luminav
