#include "services/jobs/storage/job_keeper.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;  // [us]

class JobKeeperTest : public testing::Test {
 protected:
  JobKeeperTest() {
    config_.site = {.building = "laboratory", .places = {{"lab", {1.0, 2.0, 0.0}, false}}};
    config_.state_folder = folder_.path();
    config_.boot = "boot";
  }

  /// A process that has one job, and was killed `lived` [us] after the robot was heard first.
  void leave_one_job(std::int64_t lived) {
    JobExecutor executor(config_.params, config_.site);
    JobKeeper keeper(config_, executor);
    executor.take({.id = 500, .stops = {{.place = "lab"}}}, kNow);
    keeper.tick(kNow);
    keeper.tick(kNow + lived);
    EXPECT_TRUE(keeper.keep());
  }
  /// What becomes of it in the next process, which hears the robot at a stamp [us].
  JobState state_at(std::int64_t utime) {
    JobExecutor executor(config_.params, config_.site);
    JobKeeper keeper(config_, executor);
    keeper.tick(utime);
    return executor.table().jobs.at(0).state;
  }

  TemporaryFolder folder_;
  JobsConfig config_;
};

TEST_F(JobKeeperTest, LetsJobsGoOnThatWereKeptAMomentAgo) {
  leave_one_job(0);
  EXPECT_EQ(state_at(kNow + 100'000'000), JobState::kQueued);
  EXPECT_EQ(state_at(kNow + 130'000'000), JobState::kAsking);
}

TEST_F(JobKeeperTest, NotesEveryTwentySecondsThatItLives) {
  leave_one_job(21'000'000);
  EXPECT_EQ(state_at(kNow + 130'000'000), JobState::kQueued);
}

TEST_F(JobKeeperTest, LetsJobsAskAfterAnOrderlyEnd) {
  leave_one_job(0);
  {
    JobExecutor executor(config_.params, config_.site);
    JobKeeper keeper(config_, executor);
    keeper.tick(kNow);
    keeper.end();
  }
  EXPECT_EQ(state_at(kNow + 1'000'000), JobState::kAsking);
}

TEST_F(JobKeeperTest, SaysWhyTheDiskTakesNothing) {
  folder_.write("state", "a file where a folder should be");
  config_.state_folder = folder_.path() / "state";
  JobExecutor executor(config_.params, config_.site);
  JobKeeper keeper(config_, executor);
  EXPECT_FALSE(keeper.keep());
  EXPECT_NE(keeper.error(), "");
}

}  // namespace
}  // namespace luminav
