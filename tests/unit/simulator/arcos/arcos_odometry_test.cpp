#include "drivers/simulator/arcos/arcos_odometry.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr double kStep = 0.01;  // [s]

InformationPacket packet_of(const ArcosOdometry& odometry) {
  InformationPacket packet;
  odometry.write_to(packet);
  return packet;
}

TEST(ArcosOdometry, DrivesAQuarterCircleInItsRegisters) {
  ArcosOdometry odometry(0.4);
  for (int i = 0; i < 1000; ++i) {  // radius 1 m
    odometry.add(kStep, 0.8 * 0.5e-3 * kPi, 1.2 * 0.5e-3 * kPi);
  }
  EXPECT_NEAR(odometry.theta(), 0.5 * kPi, 1e-9);
  EXPECT_NEAR(odometry.distance(), 0.5 * kPi, 1e-9);
  const InformationPacket packet = packet_of(odometry);
  EXPECT_EQ(packet.x_mm, 1000);
  EXPECT_EQ(packet.y_mm, 1000);
  EXPECT_EQ(packet.heading, 1024);
  EXPECT_EQ(packet.left_mm_s, 126);
  EXPECT_EQ(packet.right_mm_s, 188);
  EXPECT_EQ(packet.turn_rate, 90);  // 0.1 degrees/s
  EXPECT_TRUE(packet.moving);
}

TEST(ArcosOdometry, KeepsItsWheelTravelWhenTheOriginIsSet) {
  ArcosOdometry odometry(0.4);
  odometry.add(kStep, 1.0, 1.5);
  odometry.set_origin();
  EXPECT_EQ(odometry.theta(), 0.0);
  EXPECT_EQ(packet_of(odometry).x_mm, 0);
  EXPECT_DOUBLE_EQ(odometry.distance(), 1.25);
  EXPECT_EQ(odometry.encoders(1000.0).left, 1000);
  EXPECT_EQ(odometry.encoders(1000.0).right, 1500);
}

TEST(ArcosOdometry, WrapsIntoSixteenBits) {
  ArcosOdometry odometry(0.4);
  odometry.add(kStep, 33.0, 33.0);
  EXPECT_EQ(packet_of(odometry).x_mm, 33'000 - 65'536);
  EXPECT_EQ(ArcosOdometry::heading_units(2.0 * kPi + 0.5 * kPi), 1024);
}

}  // namespace
}  // namespace luminav
