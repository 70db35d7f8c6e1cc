#include "drivers/simulator/arcos/packet_schedule.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

int count_due(PacketSchedule& schedule, int steps) {
  int due = 0;
  for (int i = 0; i < steps; ++i) {
    due += schedule.step(10'000) ? 1 : 0;
  }
  return due;
}

TEST(PacketSchedule, SendsInformationOncePerCycleWithoutDrift) {
  PacketSchedule schedule(95);
  EXPECT_EQ(count_due(schedule, 9), 0);
  EXPECT_EQ(count_due(schedule, 9'491), 1000) << "95 s";
}

TEST(PacketSchedule, SendsARequestedPacketOnceOrUntilFurtherNotice) {
  PacketSchedule schedule(100);
  EXPECT_FALSE(schedule.take(PacketSchedule::kEncoders));
  schedule.request(PacketSchedule::kEncoders, 1);
  EXPECT_FALSE(schedule.take(PacketSchedule::kInputOutput));
  EXPECT_TRUE(schedule.take(PacketSchedule::kEncoders));
  EXPECT_FALSE(schedule.take(PacketSchedule::kEncoders));
  schedule.request(PacketSchedule::kEncoders, 7);
  EXPECT_TRUE(schedule.take(PacketSchedule::kEncoders));
  EXPECT_TRUE(schedule.take(PacketSchedule::kEncoders));
  schedule.request(PacketSchedule::kEncoders, 0);
  EXPECT_FALSE(schedule.take(PacketSchedule::kEncoders));
}

}  // namespace
}  // namespace luminav
