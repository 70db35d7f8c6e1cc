#include "services/jobs/job_status_publisher.hpp"

#include <gtest/gtest.h>

#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

class JobStatusPublisherTest : public testing::Test {
 protected:
  JobStatusPublisherTest() { inbox_.on(channels::kJobStatus, &JobStatusPublisherTest::on_status, this); }

  void on_status(const job_status_t& status) { heard_.push_back(status); }
  std::size_t heard() {
    while (lcm_.handleTimeout(0) > 0) {
    }
    return heard_.size();
  }

  lcm::LCM lcm_{"memq://"};
  Subscriber inbox_{lcm_};
  std::vector<job_status_t> heard_;
  JobExecutor executor_{JobParams{}, JobSite{}};
  JobStatusPublisher publisher_{lcm_};
};

TEST_F(JobStatusPublisherTest, SpeaksOnceASecondWhileNothingChanges) {
  for (std::int64_t utime = 1'000'000; utime < 4'000'000; utime += 100'000) {
    publisher_.publish(executor_, utime);
  }
  ASSERT_EQ(heard(), 3U);
  EXPECT_EQ(heard_[2].sequence, 3);
  EXPECT_EQ(heard_[2].utime, 3'000'000);
}

TEST_F(JobStatusPublisherTest, SpeaksAtOnceWhenSomethingChangesOrTheClockGoesBackOrItIsAsked) {
  publisher_.publish(executor_, 5'000'000);
  JobsFile jobs;
  jobs.tours = {{.name = "round"}};
  executor_.set_jobs(jobs);
  publisher_.publish(executor_, 5'100'000);
  EXPECT_EQ(heard(), 2U);
  publisher_.publish(executor_, 4'000'000);
  EXPECT_EQ(heard(), 3U);
  publisher_.repeat(executor_, 4'000'000);
  EXPECT_EQ(heard(), 4U);
}

}  // namespace
}  // namespace luminav
