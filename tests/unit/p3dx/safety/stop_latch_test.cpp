#include "drivers/p3dx/safety/stop_latch.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace luminav {
namespace {

std::filesystem::path empty_folder() {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "stop_latch_test";
  std::filesystem::remove_all(folder);
  return folder;
}

TEST(StopLatch, StaysUntilItIsReleased) {
  StopLatch latch;
  EXPECT_FALSE(latch.engaged());
  EXPECT_TRUE(latch.request(10, true, "viewer"));
  EXPECT_TRUE(latch.engaged());
  EXPECT_EQ(latch.id(), 10);
  EXPECT_TRUE(latch.request(11, false, "viewer"));
  EXPECT_FALSE(latch.engaged());
}

TEST(StopLatch, ReportsNoChangeForARepeatedRequest) {
  StopLatch latch;
  EXPECT_TRUE(latch.request(10, true, "viewer"));
  EXPECT_FALSE(latch.request(10, true, "viewer"));
  EXPECT_TRUE(latch.engaged());
}

TEST(StopLatch, IsNotReleasedByAnOlderRequestOfTheSameSender) {
  StopLatch latch;
  latch.request(10, true, "viewer");
  EXPECT_FALSE(latch.request(9, false, "viewer"));
  EXPECT_TRUE(latch.engaged());
}

TEST(StopLatch, ObeysAStopFromAHostWhoseClockIsBehind) {
  StopLatch latch;
  latch.request(1'000'000, true, "desk");
  latch.request(1'000'001, false, "desk");
  EXPECT_TRUE(latch.request(5, true, "tablet"));
  EXPECT_TRUE(latch.engaged());
  EXPECT_EQ(latch.id(), 5);
}

TEST(StopLatch, SurvivesARestart) {
  const std::filesystem::path folder = empty_folder();
  {
    StopLatch latch(folder);
    latch.request(77, true, "the person at the door");
    latch.save();
  }
  StopLatch latch(folder);
  EXPECT_TRUE(latch.engaged());
  EXPECT_EQ(latch.id(), 77);
  EXPECT_EQ(latch.sender(), "the person at the door");
  latch.request(78, false, "the person at the door");
  latch.save();
  EXPECT_FALSE(StopLatch(folder).engaged());
}

TEST(StopLatch, TouchesTheDiskOnlyWhenToldTo) {
  const std::filesystem::path folder = empty_folder();
  StopLatch latch(folder);
  EXPECT_TRUE(latch.request(1, true, "viewer"));
  EXPECT_FALSE(std::filesystem::exists(folder));
  latch.save();
  EXPECT_TRUE(StopLatch(folder).engaged());
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(latch.request(1, true, "viewer"));  // a repetition has nothing new to keep
  latch.save();
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(StopLatch, IsNotConfusedByADamagedFile) {
  const std::filesystem::path folder = empty_folder();
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "stop") << "rubbish";
  EXPECT_FALSE(StopLatch(folder).engaged());
}

TEST(StopLatch, StopsEvenWhereNothingCanBeWritten) {
  StopLatch latch("/proc/nowhere");
  EXPECT_TRUE(latch.request(1, true, "viewer"));
  latch.save();
  EXPECT_TRUE(latch.engaged());
}

}  // namespace
}  // namespace luminav
