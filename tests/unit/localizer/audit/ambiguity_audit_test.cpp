#include "services/localizer/audit/ambiguity_audit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/localizer/audit/audit_floor.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

CameraDescription camera() {
  CameraDescription camera;
  camera.mounting.z = 0.3;
  return camera;
}

AuditFloor floor_of(const testing::TestBuilding& building) {
  return {building.building, building.walls, camera()};
}

std::vector<AuditStart> all_starts(const AuditFloor& floor) {
  return audit_starts(floor, spread_starts(floor, 100'000));
}

TEST(AmbiguityAudit, ACorridorThatMapsOntoItselfNeverResolves) {
  const AuditFloor floor = floor_of(testing::symmetric_corridor(6, 3.0));
  EXPECT_GT(floor.ground().points.size(), 50U);
  EXPECT_NEAR(never_share(all_starts(floor)), 1.0, 1e-9);
  EXPECT_TRUE(std::isinf(StartAudit(floor).at(0).distance));
}

TEST(AmbiguityAudit, OneFixtureOfAnotherKindResolvesTheCorridor) {
  testing::TestBuilding corridor = testing::symmetric_corridor(6, 3.0);
  const AuditFloor floor = floor_of(corridor);
  const std::vector<AuditStart> before = all_starts(floor);
  const auto changes = best_changes(floor, before, 3);
  ASSERT_FALSE(changes.empty());
  EXPECT_EQ(changes.front().never_change, -1.0);
  // what it promises is what happens
  for (Fixture& fixture : corridor.building.fixtures) {
    if (fixture.id == changes.front().fixture) {
      fixture.shape = FixtureShape::kSquare;
      fixture.length = fixture.width = 0.6;
    }
  }
  const std::vector<AuditStart> after = all_starts(floor_of(corridor));
  EXPECT_EQ(never_share(after), 0.0);
  EXPECT_NEAR(mean_distance(after) - mean_distance(before), changes.front().mean_change, 0.3);
}

TEST(AmbiguityAudit, NearerToWhatIsDifferentTheWayIsShorter) {
  testing::TestBuilding corridor = testing::symmetric_corridor(7, 3.0);
  Fixture& first = corridor.building.fixtures.front();
  first.shape = FixtureShape::kSquare;
  first.length = first.width = 0.6;
  const AuditFloor floor = floor_of(corridor);
  const Eigen::Vector2d different = first.world_from_fixture.position();
  double near = 0.0;
  double far = 0.0;
  for (const AuditStart& start : all_starts(floor)) {
    const double distance = (floor.ground().points[static_cast<std::size_t>(start.place)] - different).norm();
    near = distance < 0.5 ? std::max(near, start.distance) : near;
    far = distance > 9.0 && distance < 10.0 ? std::max(far, start.distance) : far;
  }
  EXPECT_LT(near, far);
}

TEST(AmbiguityAudit, SaysWhereNothingIsSeen) {
  testing::TestBuilding corridor = testing::symmetric_corridor(4, 6.0);
  const AuditFloor floor = floor_of(corridor);
  int blind = 0;
  for (std::size_t i = 0; i < floor.ground().points.size(); ++i) {
    bool sees = false;
    for (const Fixture& fixture : corridor.building.fixtures) {
      sees = sees || (fixture.world_from_fixture.position() - floor.ground().points[i]).norm() < floor.view_radius();
    }
    EXPECT_EQ(floor.is_blind(static_cast<std::int32_t>(i)), !sees);
    blind += sees ? 0 : 1;
  }
  EXPECT_GT(blind, 0);
}

/// The corridor with nothing but round lamps.
testing::TestBuilding round_corridor(int fixtures, double pitch) {
  testing::TestBuilding corridor = testing::symmetric_corridor(fixtures, pitch);
  for (Fixture& fixture : corridor.building.fixtures) {
    fixture.shape = FixtureShape::kRound;
    fixture.length = fixture.width = 0.3;
  }
  return corridor;
}

// A round fixture tells no heading: who sees one alone knows nothing of where on the ring round it he is.
TEST(AmbiguityAudit, BelowRoundFixturesAloneTheHeadingIsOpen) {
  testing::TestBuilding corridor = round_corridor(2, 6.0);
  corridor.building.fixtures[1].length = corridor.building.fixtures[1].width = 0.6;
  const std::vector<AuditStart> starts = all_starts(floor_of(corridor));
  EXPECT_EQ(never_share(starts), 0.0);
  EXPECT_GT(distance_quantile(starts, 0.0), 0.0);
  EXPECT_TRUE(std::isinf(StartAudit(floor_of(round_corridor(2, 6.0))).at(0).distance)) << "half a turn of both";
}

TEST(AmbiguityAudit, ARowOfRoundFixturesTellsWhereItIsUneven) {
  testing::TestBuilding corridor = round_corridor(7, 2.5);
  EXPECT_NEAR(never_share(all_starts(floor_of(corridor))), 1.0, 1e-9);
  corridor.building.fixtures[1].world_from_fixture.x += 0.8;
  const std::vector<AuditStart> starts = all_starts(floor_of(corridor));
  EXPECT_EQ(never_share(starts), 0.0);
  EXPECT_LT(distance_quantile(starts, 0.0), distance_quantile(starts, 0.95));
}

TEST(AmbiguityAudit, SpreadsStartsOverTheWholeFloor) {
  const AuditFloor floor = floor_of(testing::symmetric_corridor(6, 3.0));
  const std::vector<std::int32_t> starts = spread_starts(floor, 20);
  ASSERT_EQ(starts.size(), 20U);
  EXPECT_EQ(starts, spread_starts(floor, 20));
  int left = 0;
  for (const std::int32_t start : starts) {
    left += floor.ground().points[static_cast<std::size_t>(start)].x() <
                    0.5 * (floor.ground().points.front().x() + floor.ground().points.back().x())
                ? 1
                : 0;
  }
  EXPECT_NEAR(left, 10, 2);
}

}  // namespace
}  // namespace luminav
