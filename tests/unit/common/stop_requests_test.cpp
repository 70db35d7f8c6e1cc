#include "services/common/process/stop_requests.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

using Verdict = StopRequests::Verdict;

TEST(StopRequests, ObeysAStopThatHasTheIdOfARelease) {
  StopRequests stops;
  stops.take(100, true, "viewer");
  stops.take(101, false, "viewer");
  EXPECT_EQ(stops.take(101, true, "viewer"), Verdict::kTaken);
  EXPECT_TRUE(stops.engaged());
  EXPECT_EQ(stops.take(101, false, "viewer"), Verdict::kRepeated) << "the copies of the release come still";
  EXPECT_TRUE(stops.engaged());
}

TEST(StopRequests, ObeysALateCopyOfAStopAsWell) {
  StopRequests stops;
  stops.take(10, true, "viewer");
  stops.take(11, false, "viewer");
  EXPECT_EQ(stops.take(10, true, "viewer"), Verdict::kTaken);
  EXPECT_TRUE(stops.engaged());
}

TEST(StopRequests, IsNotReleasedByARequestFromBeforeAStopOfTheSameSender) {
  StopRequests stops;
  stops.take(10, true, "desk");
  stops.take(3, true, "tablet");
  EXPECT_EQ(stops.take(9, false, "desk"), Verdict::kOutdated);
  EXPECT_EQ(stops.take(10, false, "desk"), Verdict::kOutdated);
  EXPECT_TRUE(stops.engaged());
  EXPECT_EQ(stops.take(4, false, "tablet"), Verdict::kTaken);
  EXPECT_FALSE(stops.engaged());
}

TEST(StopRequests, EchoesEachOfTwoStopsThatAreRepeated) {
  StopRequests stops;
  stops.take(10, true, "desk");
  stops.take(5, true, "tablet");
  EXPECT_EQ(stops.id(), 5);
  EXPECT_EQ(stops.take(10, true, "desk"), Verdict::kRepeated);
  EXPECT_EQ(stops.id(), 10);
  EXPECT_EQ(stops.sender(), "desk");
}

TEST(StopRequests, KeepsNoMoreOfANameThanIsShown) {
  StopRequests stops;
  stops.take(1, true, std::string(65'000, 'x'));
  EXPECT_EQ(stops.sender().size(), 64U);
  stops.take(2, false, std::string(65'000, 'x'));
  EXPECT_FALSE(stops.engaged());
}

}  // namespace
}  // namespace luminav
