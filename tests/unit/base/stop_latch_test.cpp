#include "drivers/base/safety/stop_latch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace luminav {
namespace {

using ::testing::HasSubstr;

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
    latch.save(0);
  }
  StopLatch latch(folder);
  EXPECT_TRUE(latch.engaged());
  EXPECT_EQ(latch.id(), 77);
  EXPECT_EQ(latch.sender(), "the person at the door");
  latch.request(78, false, "the person at the door");
  latch.save(0);
  latch.finish_saving();
  EXPECT_FALSE(StopLatch(folder).engaged());
}

TEST(StopLatch, TouchesTheDiskOnlyWhenToldTo) {
  const std::filesystem::path folder = empty_folder();
  StopLatch latch(folder);
  EXPECT_TRUE(latch.request(1, true, "viewer"));
  EXPECT_FALSE(std::filesystem::exists(folder));
  latch.save(0);
  latch.finish_saving();
  EXPECT_TRUE(StopLatch(folder).engaged());
  std::filesystem::remove_all(folder);
  EXPECT_FALSE(latch.request(1, true, "viewer"));  // a repetition has nothing new to keep
  latch.save(0);
  latch.finish_saving();
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(StopLatch, IsEngagedWhereTheFileIsDamaged) {
  const std::filesystem::path folder = empty_folder();
  std::filesystem::create_directories(folder);
  for (const char* text :
       {"", "rubbish", "0", "0 17", "0 17 view", "2 17 viewer\n", "0 x viewer\n", "\n", "0 17 viewer\n0 18 viewer\n"}) {
    std::ofstream(folder / "stop") << text;
    const StopLatch latch(folder);
    EXPECT_TRUE(latch.engaged()) << text;
    EXPECT_THAT(latch.sender(), HasSubstr("cannot read")) << text;
  }
  std::ofstream(folder / "stop") << "0 17 viewer\n";
  EXPECT_FALSE(StopLatch(folder).engaged());
}

TEST(StopLatch, IsEngagedWhereTheFileCannotBeRead) {
  const std::filesystem::path folder = empty_folder();
  std::filesystem::create_directories(folder / "stop");
  EXPECT_TRUE(StopLatch(folder).engaged());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::filesystem::create_symlink("nowhere", folder / "stop");
  EXPECT_TRUE(StopLatch(folder).engaged());
}

TEST(StopLatch, CanBeReleasedAfterThat) {
  const std::filesystem::path folder = empty_folder();
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "stop") << "rubbish";
  StopLatch latch(folder);
  EXPECT_TRUE(latch.request(1, false, "viewer"));
  latch.save(0);
  latch.finish_saving();
  EXPECT_FALSE(StopLatch(folder).engaged());
}

TEST(StopLatch, StopsEvenWhereNothingCanBeWrittenAndSaysSo) {
  StopLatch latch("/proc/nowhere");
  EXPECT_TRUE(latch.request(1, true, "viewer"));
  EXPECT_EQ(latch.trouble(), "");
  latch.save(0);
  latch.finish_saving();
  EXPECT_TRUE(latch.engaged());
  EXPECT_THAT(latch.trouble(), HasSubstr("would not survive a restart"));
}

TEST(StopLatch, TriesAgainUntilItIsKept) {
  const std::filesystem::path folder = empty_folder();
  std::ofstream(folder.string()) << "a file where the folder should be";
  StopLatch latch(folder);
  latch.request(1, true, "viewer");
  latch.save(0);
  latch.finish_saving();
  EXPECT_NE(latch.trouble(), "");
  std::filesystem::remove(folder);
  latch.save(500'000);  // too early
  latch.finish_saving();
  EXPECT_FALSE(std::filesystem::exists(folder));
  latch.save(1'000'000);
  latch.finish_saving();
  EXPECT_EQ(latch.trouble(), "");
  EXPECT_TRUE(StopLatch(folder).engaged());
}

}  // namespace
}  // namespace luminav
