#include "services/localizer/audit/ambiguity_audit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

CameraDescription camera() {
  CameraDescription camera;
  camera.mounting.z = 0.3;
  return camera;
}

AmbiguityAudit audit(const testing::TestBuilding& building) {
  return {building.building, building.walls, camera(), AuditParams{}};
}

TEST(AmbiguityAudit, ACorridorThatMapsOntoItselfNeverResolves) {
  const AmbiguityAudit result = audit(testing::symmetric_corridor(6, 3.0));
  EXPECT_GT(result.places().size(), 50U);
  EXPECT_NEAR(result.never_share(), 1.0, 1e-9);
  EXPECT_TRUE(std::isinf(result.places().front().min_distance));
  EXPECT_TRUE(std::isinf(ResolvingWalk(result.ground()).length(0)));
}

TEST(AmbiguityAudit, OneFixtureOfAnotherKindResolvesTheCorridor) {
  testing::TestBuilding corridor = testing::symmetric_corridor(6, 3.0);
  const auto changes = audit(corridor).best_changes(3);
  ASSERT_FALSE(changes.empty());
  EXPECT_EQ(changes.front().never_share, 0.0);
  // what it promises is what happens
  for (Fixture& fixture : corridor.building.fixtures) {
    if (fixture.id == changes.front().fixture) {
      fixture.shape = FixtureShape::kSquare;
      fixture.length = fixture.width = 0.6;
    }
  }
  const AmbiguityAudit after = audit(corridor);
  EXPECT_EQ(after.never_share(), 0.0);
  EXPECT_NEAR(after.mean_min_distance(), changes.front().mean_min_distance, 1.0);
}

TEST(AmbiguityAudit, NearerToWhatIsDifferentTheWayIsShorter) {
  testing::TestBuilding corridor = testing::symmetric_corridor(7, 3.0);
  Fixture& first = corridor.building.fixtures.front();
  first.shape = FixtureShape::kSquare;
  first.length = first.width = 0.6;
  const AmbiguityAudit result = audit(corridor);
  const Eigen::Vector2d different = first.world_from_fixture.position();
  double near = 0.0;
  double far = 0.0;
  for (const AuditPlace& place : result.places()) {
    const double distance = (place.point - different).norm();
    near = distance < 0.5 ? std::max(near, place.min_distance) : near;
    far = distance > 9.0 && distance < 10.0 ? std::max(far, place.min_distance) : far;
  }
  EXPECT_LT(near, far);
}

TEST(AmbiguityAudit, SaysWhereNothingIsSeen) {
  testing::TestBuilding corridor = testing::symmetric_corridor(4, 6.0);
  const AmbiguityAudit result = audit(corridor);
  int blind = 0;
  for (const AuditPlace& place : result.places()) {
    bool sees = false;
    for (const Fixture& fixture : corridor.building.fixtures) {
      sees = sees || (fixture.world_from_fixture.position() - place.point).norm() < result.view_radius();
    }
    EXPECT_EQ(place.is_blind, !sees);
    blind += place.is_blind ? 1 : 0;
  }
  EXPECT_GT(blind, 0);
}

}  // namespace
}  // namespace luminav
