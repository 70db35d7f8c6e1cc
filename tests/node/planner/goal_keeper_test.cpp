#include "services/planner/goals/goal_keeper.hpp"

#include <gtest/gtest.h>

#include "services/common/configuration/whole_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;  // [us]

goal_t goal(std::int64_t id) {
  goal_t message{};
  message.id = id;
  message.count = 1;
  message.poses.resize(1);
  return message;
}

class GoalKeeperTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
  GoalKeeper keeper_{folder_.path() / "state", {"boot", "laboratory"}};
};

TEST_F(GoalKeeperTest, KeepsAGoalWithHowFarItHasComeAndForgetsItWhenItIsOver) {
  keeper_.accept(goal(7));
  keeper_.update({true, 0, false}, kNow);
  keeper_.update({true, 2, false}, kNow + 1);
  ASSERT_TRUE(keeper_.recall());
  EXPECT_EQ(keeper_.recall()->goal.id, 7);
  EXPECT_EQ(keeper_.recall()->pose_index, 2);
  EXPECT_FALSE(keeper_.recall()->asks);
  EXPECT_EQ(keeper_.recall()->kept.building, "laboratory");
  EXPECT_EQ(keeper_.recall()->kept.utime, kNow + 1);
  keeper_.update({true, 2, true}, kNow + 2);
  EXPECT_TRUE(keeper_.recall()->asks) << "paused";
  keeper_.update({}, kNow + 3);
  EXPECT_FALSE(keeper_.recall());
}

TEST_F(GoalKeeperTest, WritesItAnewEveryTwentySecondsAndWhenTheClockWentBack) {
  keeper_.accept(goal(7));
  keeper_.update({true, 0, false}, kNow);
  keeper_.update({true, 0, false}, kNow + 20'000'000);
  EXPECT_EQ(keeper_.recall()->kept.utime, kNow);
  keeper_.update({true, 0, false}, kNow + 20'000'001);
  EXPECT_EQ(keeper_.recall()->kept.utime, kNow + 20'000'001);
  keeper_.update({true, 0, false}, 5);
  EXPECT_EQ(keeper_.recall()->kept.utime, 5);
}

TEST_F(GoalKeeperTest, LetsAGoalAskAfterAnOrderlyEnd) {
  keeper_.accept(goal(7));
  keeper_.update({true, 1, false}, kNow);
  keeper_.end({true, 1, false}, kNow);
  EXPECT_TRUE(keeper_.recall()->asks);
}

TEST_F(GoalKeeperTest, ForgetsWhatAnEarlierPlannerHasLeftOnceToldSo) {
  GoalKeeper before(folder_.path() / "state", {"boot", "office"});
  before.accept(goal(3));
  before.update({true, 0, false}, kNow);
  keeper_.update({}, kNow);
  ASSERT_TRUE(keeper_.recall()) << "not its own";
  keeper_.leave(*keeper_.recall());
  keeper_.update({}, kNow);
  EXPECT_FALSE(keeper_.recall());
}

TEST_F(GoalKeeperTest, SaysWhyItCannotKeepAndThatItCanAgain) {
  write_whole_file(folder_.path() / "state", "a file where the folder should be");
  keeper_.accept(goal(7));
  keeper_.update({true, 0, false}, kNow);
  EXPECT_NE(keeper_.error(), "");
  std::filesystem::remove(folder_.path() / "state");
  keeper_.update({true, 0, false}, kNow);
  EXPECT_EQ(keeper_.error(), "");
  EXPECT_TRUE(keeper_.recall());
}

}  // namespace
}  // namespace luminav
