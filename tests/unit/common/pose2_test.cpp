#include "services/common/geometry/pose2.hpp"

#include <gtest/gtest.h>

#include <random>

namespace luminav {
namespace {

void expect_near(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x, b.x, 1e-9);
  EXPECT_NEAR(a.y, b.y, 1e-9);
  EXPECT_NEAR(wrap_angle(a.theta - b.theta), 0.0, 1e-9);
}

TEST(Pose2, MapsAPointByHand) {
  const Pose2 world_from_robot{2.0, 1.0, kPi / 2.0};
  const Eigen::Vector2d in_world = world_from_robot * Eigen::Vector2d(1.0, 0.5);
  EXPECT_NEAR(in_world.x(), 1.5, 1e-12);
  EXPECT_NEAR(in_world.y(), 2.0, 1e-12);
}

TEST(Pose2, ComposesAssociativelyAndInverts) {
  std::mt19937 rng(42);
  std::uniform_real_distribution<double> uniform(-10.0, 10.0);
  for (int i = 0; i < 200; ++i) {
    const Pose2 a{uniform(rng), uniform(rng), wrap_angle(uniform(rng))};
    const Pose2 b{uniform(rng), uniform(rng), wrap_angle(uniform(rng))};
    const Pose2 c{uniform(rng), uniform(rng), wrap_angle(uniform(rng))};
    expect_near((a * b) * c, a * (b * c));
    expect_near(a * a.inverse(), Pose2{});
    expect_near(a.inverse() * a, Pose2{});
    const Eigen::Vector2d p(uniform(rng), uniform(rng));
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-9);
  }
}

TEST(Pose2, InterpolatesTheShorterWayRound) {
  const Pose2 middle = interpolate({0.0, 0.0, radians(170.0)}, {2.0, 0.0, radians(-170.0)}, 0.5);
  EXPECT_NEAR(middle.x, 1.0, 1e-12);
  EXPECT_NEAR(std::abs(middle.theta), kPi, 1e-9);
}

}  // namespace
}  // namespace luminav
