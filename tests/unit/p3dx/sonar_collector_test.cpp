#include "drivers/p3dx/sonar_collector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr std::int64_t kCycle = 40'000;  // [us]

InformationPacket with(std::vector<SonarReading> readings) {
  InformationPacket packet;
  packet.sonar = std::move(readings);
  return packet;
}

TEST(SonarCollector, BeginsWithoutAnyReading) {
  const sonar_t message = SonarCollector(16, 5.0).message();
  EXPECT_EQ(message.count, 16);
  EXPECT_THAT(message.range, testing::Each(5.0F));
  EXPECT_THAT(message.has_echo, testing::Each(0));
  EXPECT_THAT(message.range_utime, testing::Each(0));
}

TEST(SonarCollector, MarksOnlyTheNewReadings) {
  SonarCollector collector(16, 5.0);
  collector.update(with({{0, 1500}, {8, 5000}}), 1'000'000, kCycle);
  collector.update(with({{1, 700}}), 1'100'000, kCycle);
  const sonar_t message = collector.message();
  EXPECT_FALSE(message.fresh[0]);
  EXPECT_TRUE(message.fresh[1]);
  EXPECT_FLOAT_EQ(message.range[0], 1.5F);
  EXPECT_TRUE(message.has_echo[0]);
  EXPECT_FALSE(message.has_echo[8]);  // 5 m is nothing, not a wall
  EXPECT_FLOAT_EQ(message.range[8], 5.0F);
}

TEST(SonarCollector, StampsTheReadingsOfAnArrayOneCycleApart) {
  SonarCollector collector(16, 5.0);
  collector.update(with({{2, 1000}, {10, 1000}, {3, 1000}, {11, 1000}, {4, 1000}}), 1'000'000, kCycle);
  const sonar_t message = collector.message();
  EXPECT_EQ(message.range_utime[4], 980'000);
  EXPECT_EQ(message.range_utime[3], 940'000);
  EXPECT_EQ(message.range_utime[2], 900'000);
  EXPECT_EQ(message.range_utime[11], 980'000);
  EXPECT_EQ(message.range_utime[10], 940'000);
  EXPECT_EQ(message.utime, 980'000);
}

TEST(SonarCollector, StampsAllAtOnceWhenARobotSendsThemSo) {
  SonarCollector collector(16, 5.0);
  std::vector<SonarReading> all;
  for (int i = 0; i < 16; ++i) {
    all.push_back({i, 1000});
  }
  collector.update(with(all), 1'000'000, kCycle);
  EXPECT_THAT(collector.message().range_utime, testing::Each(1'000'000));
}

TEST(SonarCollector, KeepsTheLastOfADiscThatFiredTwice) {
  SonarCollector collector(16, 5.0);
  collector.update(with({{5, 1000}, {5, 2000}}), 1'000'000, kCycle);
  EXPECT_FLOAT_EQ(collector.message().range[5], 2.0F);
}

TEST(SonarCollector, PassesOverDiscsThatTheRobotShouldNotHave) {
  SonarCollector collector(8, 5.0);
  collector.update(with({{9, 1000}, {31, 1000}}), 1'000'000, kCycle);
  EXPECT_EQ(collector.message().count, 8);
}

}  // namespace
}  // namespace luminav
