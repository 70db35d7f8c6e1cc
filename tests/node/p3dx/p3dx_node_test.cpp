#include <gtest/gtest.h>

#include "tests/node/p3dx/p3dx_bench.hpp"

namespace luminav {
namespace {

TEST(P3dxNode, ConnectsAndSwitchesTheMotorsOn) {
  P3dxBench bench;
  bench.run(2.0);
  ASSERT_FALSE(bench.status.empty());
  EXPECT_TRUE(bench.status.back().connected);
  EXPECT_TRUE(bench.status.back().motors_enabled);
  EXPECT_TRUE(bench.base.outputs.motors_enabled);
  EXPECT_NEAR(bench.status.back().deceleration, 1.0, 1e-9);  // as the robot reads it back
  EXPECT_NE(bench.status.back().session, 0);
}

TEST(P3dxNode, PublishesStatusAt50HzAndOdometryAndSonarAt10Hz) {
  P3dxBench bench;
  bench.run(2.0);
  bench.status.clear();
  bench.odometry.clear();
  bench.sonar.clear();
  bench.run(10.0);
  EXPECT_NEAR(static_cast<double>(bench.status.size()), 500.0, 1.0);
  EXPECT_NEAR(static_cast<double>(bench.odometry.size()), 100.0, 1.0);
  EXPECT_EQ(bench.odometry.size(), bench.sonar.size());
}

TEST(P3dxNode, DrivesAsCommandedAndMeasuresIt) {
  P3dxBench bench;
  bench.run(2.0);
  bench.drive(0.3, 0.0);
  bench.run(10.0);
  EXPECT_NEAR(bench.base.outputs.linear, 0.3, 1e-9);
  EXPECT_NEAR(bench.odometry.back().linear, 0.3, 1e-3);
  EXPECT_NEAR(bench.odometry.back().x, bench.base.travel, 0.04);  // one cycle behind
  EXPECT_TRUE(bench.status.back().command_fresh);
  EXPECT_EQ(bench.status.back().reason, "");
}

}  // namespace
}  // namespace luminav
