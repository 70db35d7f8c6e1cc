#include "services/operator/job_order.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

/// The job service on the other side of the bus.
class JobOrderTest : public ::testing::Test {
 protected:
  JobOrderTest() : inbox_(lcm_) { inbox_.on(channels::kJob, &JobOrderTest::on_job, this); }
  void on_job(const job_t& message) { ids_.push_back(message.id); }
  static job_t request(std::int64_t id) {
    job_t message{};
    message.utime = message.id = id;
    return message;
  }
  void tick(JobOrder& order) {
    order.tick();
    drain();
  }
  void drain() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  void echo(std::vector<std::int64_t> ids, const std::string& objection = "") {
    job_status_t status{};
    status.utime = 1;
    status.echo_count = static_cast<std::int32_t>(ids.size());
    status.objections.assign(ids.size(), objection);
    status.echo_ids = std::move(ids);
    lcm_.publish(channels::kJobStatus, &status);
    drain();
  }

  lcm::LCM lcm_{"memq://"};
  Subscriber inbox_;
  std::vector<std::int64_t> ids_;
};

TEST_F(JobOrderTest, RepeatsUntilItIsEchoed) {
  JobOrder order(lcm_, request(500));
  tick(order);
  tick(order);
  echo({300, 400});
  EXPECT_FALSE(order.objection());
  tick(order);
  EXPECT_EQ(ids_.size(), 3U);
  echo({400, 500}, "no place \"attic\"");
  ASSERT_TRUE(order.objection());
  EXPECT_EQ(*order.objection(), "no place \"attic\"");
  tick(order);
  EXPECT_EQ(ids_.size(), 3U);
}

TEST_F(JobOrderTest, SaysWhenNobodyAnswers) {
  JobOrder order(lcm_, request(500));
  for (int i = 0; i < 30; ++i) {
    tick(order);
  }
  EXPECT_TRUE(order.is_unanswered());
}

TEST_F(JobOrderTest, TakesAnotherIdWhereItsOwnIsBelowAllThatAreKnown) {
  JobOrder order(lcm_, request(500));
  tick(order);
  echo({1000, 1001});
  tick(order);
  EXPECT_EQ(ids_.back(), 500) << "there is room for it yet";
  std::vector<std::int64_t> full(job_status_t::MAX_ECHOES);
  for (std::size_t i = 0; i < full.size(); ++i) {
    full[i] = 1000 + static_cast<std::int64_t>(i);
  }
  echo(full);
  tick(order);
  EXPECT_EQ(ids_.back(), full.back() + 1);
  EXPECT_EQ(order.id(), full.back() + 1);
}

TEST_F(JobOrderTest, TakesAnotherIdWhereItsOwnIsTooOldForTheService) {
  JobOrder order(lcm_, request(500));
  tick(order);
  echo({500 + job_status_t::MAX_AGE + 1});
  tick(order);
  EXPECT_EQ(ids_.back(), 500 + job_status_t::MAX_AGE + 2);
  EXPECT_EQ(order.id(), 500 + job_status_t::MAX_AGE + 2);
}

TEST_F(JobOrderTest, TakesAnotherIdWhereTheRobotsOwnJobIsMuchNewer) {
  JobOrder order(lcm_, request(500));
  tick(order);
  job_status_t status{};
  status.utime = 1;
  status.count = 1;
  status.jobs.resize(1);
  status.jobs[0].id = 500 + job_status_t::MAX_AGE + 1;  // a tour by the robot's clock
  lcm_.publish(channels::kJobStatus, &status);
  drain();
  tick(order);
  EXPECT_EQ(ids_.back(), 500 + job_status_t::MAX_AGE + 2);
}

}  // namespace
}  // namespace luminav
