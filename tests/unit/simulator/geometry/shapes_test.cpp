#include "drivers/simulator/geometry/shapes.hpp"

#include <gtest/gtest.h>

#include "drivers/simulator/geometry/random_stream.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

const Polygon kUnitSquare{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};

TEST(Shapes, MeasureTheDistanceBetweenPolygons) {
  EXPECT_NEAR(distance(kUnitSquare, rectangle({2.5, 0.5, 0.0}, 1.0, 1.0)), 1.0, 1e-12);  // side to side
  EXPECT_NEAR(distance(kUnitSquare, rectangle({1.0 + 3.0 + 0.5, 1.0 + 4.0 + 0.5, 0.0}, 1.0, 1.0)), 5.0, 1e-12);
  EXPECT_NEAR(distance(kUnitSquare, rectangle({2.0, 0.5, 0.25 * kPi}, 1.0, 1.0)), 1.0 - std::sqrt(0.5), 1e-12);
}

TEST(Shapes, HaveNoDistanceWhenTheyOverlap) {
  EXPECT_EQ(distance(kUnitSquare, rectangle({0.5, 0.5, 0.3}, 0.1, 0.1)), 0.0);  // one inside the other
  EXPECT_EQ(distance(kUnitSquare, rectangle({0.5, 0.5, 0.0}, 3.0, 0.2)), 0.0);  // a cross: no corner inside the other
  EXPECT_EQ(distance(kUnitSquare, Vector2d(0.2, 0.9)), 0.0);
}

TEST(Shapes, MeasureTheDistanceToAPoint) {
  EXPECT_NEAR(distance(kUnitSquare, Vector2d(0.5, 1.5)), 0.5, 1e-12);
  EXPECT_NEAR(distance(kUnitSquare, Vector2d(4.0, 5.0)), 5.0, 1e-12);
}

TEST(Shapes, MeasureTheDistanceToALine) {
  EXPECT_NEAR(distance(kUnitSquare, Polygon{{-1.0, 1.5}, {3.0, 1.5}}), 0.5, 1e-12);
  EXPECT_NEAR(distance(kUnitSquare, Polygon{{2.0, 0.5}, {3.0, 0.5}}), 1.0, 1e-12);
  EXPECT_EQ(distance(kUnitSquare, Polygon{{-1.0, 0.5}, {3.0, 0.6}}), 0.0);
}

TEST(Shapes, DistanceIsSymmetricAndFollowsBothWhenMovedTogether) {
  RandomStream random(3, "shapes");
  for (int i = 0; i < 500; ++i) {
    const auto pose = [&] {
      return Pose2{random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-3.0, 3.0)};
    };
    const Polygon a = rectangle(pose(), 1.0, 0.4);
    const Polygon b = rectangle(pose(), 0.7, 0.2);
    const Pose2 moved = pose();
    EXPECT_EQ(distance(a, b), distance(b, a));
    EXPECT_NEAR(distance(a, b), distance(transform(moved, a), transform(moved, b)), 1e-9);
  }
}

TEST(Shapes, StopRaysAtTheNearSide) {
  const auto hit = cast_ray({-2.0, 0.25}, {1.0, 0.0}, kUnitSquare);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance, 2.0, 1e-12);
  EXPECT_NEAR(hit->normal.x(), -1.0, 1e-12);
  EXPECT_FALSE(cast_ray({-2.0, 1.25}, {1.0, 0.0}, kUnitSquare).has_value());   // passes above
  EXPECT_FALSE(cast_ray({-2.0, 0.25}, {-1.0, 0.0}, kUnitSquare).has_value());  // looks away
  EXPECT_FALSE(cast_ray({0.5, 0.5}, {1.0, 0.0}, kUnitSquare).has_value());     // from inside
}

TEST(Shapes, StopRaysAtDiscs) {
  const Disc disc{{3.0, 0.0}, 0.5};
  const auto hit = cast_ray({0.0, 0.0}, {1.0, 0.0}, disc);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance, 2.5, 1e-12);
  EXPECT_NEAR(hit->normal.x(), -1.0, 1e-12);
  EXPECT_FALSE(cast_ray({0.0, 0.6}, {1.0, 0.0}, disc).has_value());
  EXPECT_FALSE(cast_ray({0.0, 0.0}, {-1.0, 0.0}, disc).has_value());
}

}  // namespace
}  // namespace luminav
