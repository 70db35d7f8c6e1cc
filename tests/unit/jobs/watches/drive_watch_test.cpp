#include "services/jobs/watches/drive_watch.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

const DriveTarget kLab{"lab", {1.0, 2.0, 0.5}, true};
const DriveTarget kElsewhere{"", {5.0, 5.0, 0.0}, false};

TEST(DriveWatch, AsksUntilThePlannerEchoesTheId) {
  DriveWatch drive;
  EXPECT_FALSE(drive.request());
  drive.begin(kLab, 1000);
  ASSERT_TRUE(drive.request());
  EXPECT_EQ(drive.request()->id, 1000);
  drive.hear({999, Drive::kArrived, "", kElsewhere});
  EXPECT_TRUE(drive.request()) << "an older goal's end is none of ours";
  EXPECT_EQ(drive.state(), Drive::kUnderWay);
  drive.hear({1000, Drive::kUnderWay, "", kLab, 4.0});
  EXPECT_FALSE(drive.request());
  EXPECT_EQ(drive.distance_left(), 4.0);
  drive.hear({1000, Drive::kBlocked, "a door is shut", kLab});
  EXPECT_EQ(drive.state(), Drive::kBlocked);
  EXPECT_EQ(drive.cause(), "a door is shut");
}

TEST(DriveWatch, TakesAnIdAboveThatOfSomebodyWhoseClockIsAhead) {
  DriveWatch drive;
  drive.begin(kLab, 1000);
  drive.hear({5000, Drive::kArrived, "", kElsewhere});
  EXPECT_EQ(drive.request()->id, 5001);
  drive.forget();
  drive.begin(kLab, 2000);
  EXPECT_EQ(drive.request()->id, 5002) << "and stays above it";
}

TEST(DriveWatch, IsReplacedByAGoalElsewhereButNotByAPause) {
  DriveWatch drive;
  drive.begin(kLab, 1000);
  drive.hear({1000, Drive::kUnderWay, "", kLab});
  drive.hear({1500, Drive::kPaused, "", kLab});
  EXPECT_EQ(drive.state(), Drive::kPaused);
  EXPECT_EQ(drive.goal_id(), 1500);
  drive.hear({1600, Drive::kUnderWay, "", kElsewhere});
  EXPECT_EQ(drive.state(), Drive::kReplaced);
  EXPECT_FALSE(drive.is_open());
}

TEST(DriveWatch, IsOverWhenItsCancellationIsEchoedWhateverThePlannerDid) {
  DriveWatch drive;
  drive.begin(kLab, 1000);
  drive.hear({1000, Drive::kUnderWay, "", kLab});
  drive.cancel(1100);
  EXPECT_EQ(drive.request()->action, DriveAction::kCancel);
  drive.hear({1000, Drive::kArrived, "", kLab});
  EXPECT_TRUE(drive.request());
  drive.hear({1100, Drive::kCancelled, "", kLab});
  EXPECT_FALSE(drive.request());
  EXPECT_EQ(drive.state(), Drive::kCancelled);
}

TEST(DriveWatch, CancelsNobodyElsesGoal) {
  DriveWatch drive;
  drive.begin(kLab, 1000);
  drive.hear({1000, Drive::kUnderWay, "", kLab});
  drive.cancel(1100);
  drive.hear({1500, Drive::kUnderWay, "", kElsewhere});
  EXPECT_FALSE(drive.request());
  EXPECT_EQ(drive.state(), Drive::kReplaced);

  drive.begin(kLab, 2000);
  drive.hear({2000, Drive::kUnderWay, "", kLab});
  drive.cancel(2100);
  drive.hear({2500, Drive::kPaused, "", kLab});
  ASSERT_TRUE(drive.request()) << "a pause by somebody else is about our goal";
  EXPECT_EQ(drive.request()->id, 2501);

  DriveWatch fresh;
  fresh.take_over({}, 3000);
  fresh.cancel(3001);
  fresh.hear({4000, Drive::kUnderWay, "", kElsewhere});
  EXPECT_FALSE(fresh.request());
}

TEST(DriveWatch, TakesOverADriveThatWasPausedMeanwhile) {
  DriveWatch drive;
  drive.take_over(kLab, 1000);
  drive.hear({1200, Drive::kPaused, "", kLab});
  EXPECT_EQ(drive.state(), Drive::kPaused);
  EXPECT_FALSE(drive.request());
}

TEST(DriveWatch, TakesNoArrivalElsewhereForItsOwn) {
  DriveWatch drive;
  drive.take_over(kLab, 1000);
  drive.hear({1000, Drive::kArrived, "", kElsewhere});
  EXPECT_EQ(drive.state(), Drive::kForgotten);
}

}  // namespace
}  // namespace luminav
