#include "services/mapper/sonar/surface_patch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

TEST(SurfacePatch, KnowsTheDirectionOfAWall) {
  SurfacePatch along;
  SurfacePatch across;
  SurfacePatch slanted;
  for (int i = -SurfacePatch::kReach; i <= SurfacePatch::kReach; ++i) {
    along.add(i, 0);
    across.add(0, i);
    slanted.add(i, i);
  }
  EXPECT_NEAR(along.direction().value(), 0.0, 1e-9);
  EXPECT_NEAR(std::abs(across.direction().value()), 0.5 * kPi, 1e-9);
  EXPECT_NEAR(slanted.direction().value(), 0.25 * kPi, 1e-9);
}

TEST(SurfacePatch, FindsNoSurfaceInAHeapOrInThreeCells) {
  SurfacePatch heap;
  SurfacePatch three;
  for (int i = -1; i <= 1; ++i) {
    three.add(i, 0);
    for (int k = -1; k <= 1; ++k) {
      heap.add(i, k);
    }
  }
  EXPECT_FALSE(heap.direction());
  EXPECT_FALSE(three.direction());
}

TEST(SurfacePatch, TellsTheTwoFacesOfAWallApart) {
  SurfacePatch both;
  for (int i = -SurfacePatch::kReach; i <= SurfacePatch::kReach; ++i) {
    both.add(i, 0);
    both.add(i, 3);
  }
  EXPECT_FALSE(both.direction());
  EXPECT_NEAR(both.connected_to_middle().direction().value(), 0.0, 1e-9);
}

TEST(SurfacePatch, EndsAtItsEdges) {
  SurfacePatch patch;  // the end of one row and the start of the next are not neighbours
  patch.add(0, 0);
  patch.add(1, 0);
  patch.add(2, 0);
  patch.add(3, 0);
  for (int i = 0; i <= 2; ++i) {
    patch.add(-3, i);
  }
  EXPECT_NEAR(patch.connected_to_middle().direction().value(), 0.0, 1e-9);
}

TEST(SurfacePatch, NothingHangsTogetherWithAFreeMiddle) {
  SurfacePatch patch;
  for (int i = -3; i <= 3; ++i) {
    patch.add(i, 1);
  }
  EXPECT_TRUE(patch.direction());
  EXPECT_FALSE(patch.connected_to_middle().direction());
}

}  // namespace
}  // namespace luminav
