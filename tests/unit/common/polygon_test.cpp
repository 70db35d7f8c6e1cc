#include "services/common/geometry/polygon.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

const Polygon kAngle = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 1.0}, {1.0, 1.0}, {1.0, 3.0}, {0.0, 3.0}};  // an L

TEST(Polygon, ContainsWhatLiesInsideWhicheverWayRoundItsCornersAre) {
  Polygon other_way(kAngle.rbegin(), kAngle.rend());
  for (const Polygon& polygon : {kAngle, other_way}) {
    EXPECT_TRUE(contains(polygon, {3.5, 0.5}));
    EXPECT_TRUE(contains(polygon, {0.5, 2.5}));
    EXPECT_FALSE(contains(polygon, {2.0, 2.0}));
    EXPECT_FALSE(contains(polygon, {-0.1, 0.5}));
    EXPECT_FALSE(contains(polygon, {5.0, 1.0}));
  }
}

TEST(Polygon, MeasuresTheDistanceToItsEdgeFromBothSides) {
  EXPECT_NEAR(distance_to_edge(kAngle, {2.0, 2.0}), 1.0, 1e-12);
  EXPECT_NEAR(distance_to_edge(kAngle, {3.0, 0.4}), 0.4, 1e-12);
  EXPECT_NEAR(distance_to_edge(kAngle, {7.0, -4.0}), 5.0, 1e-12);
}

TEST(Polygon, IsSimpleUnlessEdgesCrossOrTouch) {
  EXPECT_TRUE(is_simple(kAngle));
  EXPECT_TRUE(is_simple({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}));
  EXPECT_FALSE(is_simple({{0.0, 0.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}})) << "a bow tie";
  EXPECT_FALSE(is_simple({{0.0, 0.0}, {1.0, 0.0}}));
  EXPECT_FALSE(is_simple({}));
}

TEST(Polygon, GivesPointsOfItsEdgeNoFartherApartThanAsked) {
  const std::vector<Eigen::Vector2d> points = edge_points(kAngle, 0.3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((points[(i + 1) % points.size()] - points[i]).norm(), 0.3 + 1e-12);
    EXPECT_LT(distance_to_edge(kAngle, points[i]), 1e-12);
  }
}

}  // namespace
}  // namespace luminav
