#include "services/controller/following/lookahead.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace luminav {
namespace {

using Path = std::vector<Eigen::Vector2d>;

const LineTest kAllFree = [](const Eigen::Vector2d&, const Eigen::Vector2d&) { return true; };
const Path kStraight{{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {3.0, 0.0}};

TEST(LookAhead, IsAMetreFurtherAlongThePath) {
  const LookAhead result = find_look_ahead(kStraight, 0.0, {0.5, 0.1}, {}, kAllFree);
  EXPECT_NEAR(result.point.x(), 1.5, 1e-12);
  EXPECT_NEAR(result.point.y(), 0.0, 1e-12);
  EXPECT_NEAR(result.travelled, 0.5, 1e-12);
  EXPECT_NEAR(result.distance_left, std::hypot(2.5, 0.1), 1e-12);
}

TEST(LookAhead, EndsAtTheEndOfThePath) {
  const LookAhead result = find_look_ahead(kStraight, 2.0, {2.8, 0.0}, {}, kAllFree);
  EXPECT_NEAR(result.point.x(), 3.0, 1e-12);
  EXPECT_NEAR(result.distance_left, 0.2, 1e-12);
}

TEST(LookAhead, IsShortenedUntilItIsInSight) {
  const LineTest near_only = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return (to - from).norm() < 0.65;
  };
  EXPECT_NEAR(find_look_ahead(kStraight, 0.0, {0.0, 0.0}, {}, near_only).point.x(), 0.6, 1e-9);
  const LineTest none = [](const Eigen::Vector2d&, const Eigen::Vector2d&) { return false; };
  EXPECT_NEAR(find_look_ahead(kStraight, 0.0, {0.0, 0.0}, {}, none).point.x(), LookAheadParams{}.min, 1e-9);
}

TEST(LookAhead, NeverGoesBackWhereAPathCrossesItself) {
  // a loop that comes back to its start and goes on to the right
  const Path loop{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}, {0.0, -2.0}};
  EXPECT_LT(find_look_ahead(loop, 0.0, {0.1, 0.0}, {}, kAllFree).travelled, 0.2);
  EXPECT_NEAR(find_look_ahead(loop, 7.5, {0.0, 0.1}, {}, kAllFree).travelled, 7.9, 1e-9);
  EXPECT_GE(find_look_ahead(loop, 5.0, {1.0, 0.0}, {}, kAllFree).travelled, 5.0);
}

TEST(LookAhead, TakesAPathOfOnePoint) {
  const LookAhead result = find_look_ahead(std::vector<Eigen::Vector2d>{{1.0, 1.0}}, 0.0, {0.0, 1.0}, {}, kAllFree);
  EXPECT_NEAR(result.point.x(), 1.0, 1e-12);
  EXPECT_NEAR(result.distance_left, 1.0, 1e-12);
}

TEST(LookAhead, BearsDoublePoints) {
  const LookAhead result = find_look_ahead(std::vector<Eigen::Vector2d>{{0.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}},
                                           0.0, {0.5, 0.0}, {}, kAllFree);
  EXPECT_NEAR(result.travelled, 0.5, 1e-12);
  EXPECT_NEAR(result.point.x(), 1.0, 1e-12);
}

}  // namespace
}  // namespace luminav
