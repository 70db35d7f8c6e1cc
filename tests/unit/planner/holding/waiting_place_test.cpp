#include "services/planner/holding/waiting_place.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

const Door kDoor{1, {4.2, 3.2, 0.5 * kPi}, 0.9};
const Polyline kPath = {{2.0, 3.0}, {3.0, 3.2}, {4.2, 3.2}, {6.0, 3.2}};

/// Two rooms of 4 x 6 m with a door between them.
OccupancyGrid two_rooms() {
  OccupancyGrid grid = empty_room(8.2, 6.0);
  build_wall(grid, 4.1, 0.0, 4.3, 6.4);
  build_wall(grid, 4.1, 2.75, 4.3, 3.65, Prior::kFree);
  return grid;
}

TEST(WaitingPlace, LiesBesideTheWayOnTheSideFromWhichItComes) {
  const ConfigurationSpace space({}, two_rooms(), {});
  const auto places = places_beside(kDoor, kPath, space);
  ASSERT_FALSE(places.empty());
  for (const Eigen::Vector2d& place : places) {
    EXPECT_LT(place.x(), 3.8);
    EXPECT_GT(place.x(), 2.9);
    EXPECT_GT(std::abs(place.y() - 3.2), 0.8) << "half a robot and who passes it";
    EXPECT_FALSE(is_in_doorway(kDoor, place));
    EXPECT_GE(space.clearance(space.geometry().cell_at(place)), 0.4) << "it can turn";
  }
  EXPECT_LE((places.front() - kPath.front()).norm(), (places.back() - kPath.front()).norm());
}

TEST(WaitingPlace, LiesBehindARobotThatStandsInTheDoor) {
  const ConfigurationSpace space({}, two_rooms(), {});
  for (const double x : {4.1, 4.3}) {
    const auto out = places_beside(kDoor, {{x, 3.2}, {6.0, 3.2}}, space);
    ASSERT_FALSE(out.empty());
    EXPECT_LT(out.front().x(), 4.0);
    const auto back = places_beside(kDoor, {{x, 3.2}, {2.0, 3.2}}, space);
    ASSERT_FALSE(back.empty());
    EXPECT_GT(back.front().x(), 4.4);
  }
}

TEST(WaitingPlace, IsWhereThereIsRoom) {
  OccupancyGrid grid = two_rooms();
  build_wall(grid, 0.0, 3.6, 4.2, 6.4);  // nothing to the left of the way
  const ConfigurationSpace space({}, grid, {});
  const auto places = places_beside(kDoor, kPath, space);
  ASSERT_FALSE(places.empty());
  for (const Eigen::Vector2d& place : places) {
    EXPECT_LT(place.y(), 3.2);
  }
  build_wall(grid, 0.0, 0.0, 4.2, 2.8);  // nor to the right: a corridor that ends at the door
  EXPECT_TRUE(places_beside(kDoor, kPath, ConfigurationSpace({}, grid, {})).empty());
}

TEST(WaitingPlace, KnowsWhatLiesInTheWayThroughADoor) {
  EXPECT_TRUE(is_in_opening(kDoor, {4.3, 3.4}));
  EXPECT_FALSE(is_in_opening(kDoor, {3.7, 3.2}));
  EXPECT_FALSE(is_in_opening(kDoor, {4.2, 4.0}));
  EXPECT_TRUE(is_in_doorway(kDoor, {3.4, 3.4}));
  EXPECT_TRUE(is_in_doorway(kDoor, {5.0, 3.0}));
  EXPECT_FALSE(is_in_doorway(kDoor, {2.4, 3.2})) << "there is room to pass each other";
  EXPECT_FALSE(is_in_doorway(kDoor, {3.4, 4.1}));
}

}  // namespace
}  // namespace luminav
