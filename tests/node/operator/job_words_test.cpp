#include "services/operator/job_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;

/// One job that waits to be loaded, one that asks, one in the queue, one that is over.
job_status_t some_jobs() {
  job_status_t status{};
  const auto add = [&](std::int64_t id, std::int8_t state, int position) {
    job_state_t job{};
    job.id = id;
    job.kind = job_t::KIND_CARRY;
    job.state = state;
    job.position = position;
    job.stops = {"lab", "office"};
    job.stop_count = 2;
    job.sentence = "a sentence";
    status.jobs.push_back(job);
  };
  add(1'764'000'000'001'234, job_state_t::STATE_AT_STOP, 0);
  status.jobs.back().waits_for = "loaded";
  add(1'764'000'000'005'678, job_state_t::STATE_ASKING, 1);
  status.jobs.back().answers = {"opened", "give up"};
  status.jobs.back().answer_count = 2;
  add(1'764'000'000'009'034, job_state_t::STATE_DONE, -1);
  status.count = 3;
  status.tours = {"morning"};
  return status;
}

TEST(JobWords, ReadWhatAPersonTypes) {
  const job_status_t status = some_jobs();
  EXPECT_EQ(make_job({"go", "office", "7"}, status).stops[0].place, "office 7");
  const job_t point = make_job({"go", "1.5", "-2", "90deg"}, status);
  EXPECT_DOUBLE_EQ(point.stops[0].y, -2.0);
  EXPECT_NEAR(point.stops[0].theta, 1.5708, 1e-3);
  const job_t carry = make_job({"carry", "lab", "office 7"}, status);
  EXPECT_EQ(carry.kind, job_t::KIND_CARRY);
  ASSERT_EQ(carry.count, 2);
  EXPECT_EQ(carry.stops[1].place, "office 7");
  EXPECT_EQ(make_job({"tour", "morning"}, status).tour, "morning");
  EXPECT_EQ(make_job({"tour", "lab", "office"}, status).count, 2);
  EXPECT_EQ(make_job({"home"}, status).kind, job_t::KIND_HOME);
}

TEST(JobWords, FindTheJobThatIsMeant) {
  const job_status_t status = some_jobs();
  const job_t confirm = make_job({"confirm", "loaded"}, status);
  EXPECT_EQ(confirm.job, 1'764'000'000'001'234);
  EXPECT_EQ(confirm.word, "loaded");
  const job_t answer = make_job({"answer", "give", "up"}, status);
  EXPECT_EQ(answer.job, 1'764'000'000'005'678);
  EXPECT_EQ(answer.word, "give up");
  EXPECT_EQ(make_job({"cancel", "678"}, status).job, 1'764'000'000'005'678);
  EXPECT_THROW((void)make_job({"cancel"}, status), ConfigurationError) << "two could be meant";
  EXPECT_THROW((void)make_job({"cancel", "34"}, status), ConfigurationError) << "two end so";
  EXPECT_THROW((void)make_job({"cancel", "999"}, status), ConfigurationError);
  EXPECT_THROW((void)make_job({"confirm"}, job_status_t{}), ConfigurationError);
}

TEST(JobWords, RefuseWhatIsNoOrder) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{}, {"fly"}, {"go"}, {"carry"}, {"home", "lab"}, {"go", "1", "2", "3", "4"}}) {
    EXPECT_THROW((void)make_job(words, job_status_t{}), ConfigurationError);
  }
}

TEST(JobWords, TellOfTheQueue) {
  const std::string page = page_of(some_jobs());
  EXPECT_THAT(page, HasSubstr("now  at a stop  1764000000001234 carry to lab, office: a sentence\n"));
  EXPECT_THAT(page, HasSubstr("(opened | give up)"));
  EXPECT_THAT(page, HasSubstr("tours: morning"));
  EXPECT_EQ(page_of(job_status_t{}), "no jobs\n");
  EXPECT_THAT(json_of(some_jobs()), HasSubstr("\"waits_for\": \"loaded\""));
}

}  // namespace
}  // namespace luminav
