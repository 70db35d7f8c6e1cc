#include "services/jobs/job_queue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/jobs/pretended_robot.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::int64_t> ids(const std::vector<const Job*>& jobs) {
  std::vector<std::int64_t> ids;
  for (const Job* job : jobs) {
    ids.push_back(job->id);
  }
  return ids;
}

TEST(JobQueue, PutsTheHighestPriorityFirstAndEqualOnesInTheOrderOfTheirComing) {
  PretendedRobot robot;
  const std::int64_t first = robot.add(JobKind::kGo, {"lab"}, 1);
  const std::int64_t second = robot.add(JobKind::kGo, {"lab"}, 5);
  const std::int64_t third = robot.add(JobKind::kGo, {"lab"}, 5);
  EXPECT_THAT(ids(robot.executor.queue().in_order()), ElementsAre(second, third, first));
  robot.run(3.0);
  robot.add(JobKind::kGo, {"lab"}, 100);
  EXPECT_EQ(robot.executor.table().active, second) << "what is under way is not interrupted";
}

TEST(JobQueue, TakesTenJobsAtOnceAndDoesThemOneByOne) {
  PretendedRobot robot;
  for (int i = 0; i < 10; ++i) {
    ASSERT_NE(robot.add(JobKind::kGo, {i % 2 == 0 ? "lab" : "office"}), 0);
  }
  for (int i = 0; i < 10; ++i) {
    robot.arrive();
    robot.run(1.0);
  }
  int done = 0;
  for (const Job& job : robot.executor.table().jobs) {
    done += job.state == JobState::kDone ? 1 : 0;
  }
  EXPECT_EQ(done, 10);
  EXPECT_EQ(robot.goals.size(), 10U);
}

TEST(JobQueue, ActsOnARepeatedRequestOnce) {
  PretendedRobot robot;
  JobRequest request;
  request.id = 7;
  request.stops = {{.place = "lab"}};
  EXPECT_EQ(robot.ask(request), "");
  EXPECT_EQ(robot.ask(request), "");
  EXPECT_EQ(robot.executor.table().jobs.size(), 1U);
  // as many requests later that nobody repeats it any more
  for (int i = 0; i < 40; ++i) {
    robot.say(JobRequest::Action::kConfirm, 1);
  }
  robot.executor.take(request, 1);
  EXPECT_EQ(robot.executor.table().jobs.size(), 1U);
  EXPECT_EQ(robot.executor.table().echoes.size(), JobQueue::kMaxEchoes);
}

TEST(JobQueue, ActsOnNoRequestThatIsTenMinutesOlderThanTheNewest) {
  constexpr std::int64_t kNewest = 1'764'184'500'000'000;
  JobQueue queue;
  EXPECT_FALSE(queue.is_known(1)) << "nothing is newer yet";
  queue.echo(kNewest, "");
  queue.echo(kNewest - JobQueue::kMaxAge, "");
  EXPECT_FALSE(queue.is_known(kNewest - JobQueue::kMaxAge + 1));
  EXPECT_TRUE(queue.is_known(kNewest - JobQueue::kMaxAge - 1));
  EXPECT_TRUE(queue.is_known(kNewest - 86'400'000'000)) << "a log of yesterday is played";
  EXPECT_FALSE(queue.is_known(kNewest + 86'400'000'000));
}

TEST(JobQueue, MeasuresTheAgeOfARequestByItsOwnJobsToo) {
  PretendedRobot robot;
  robot.moment.utime = 1'764'184'500'000'000;
  robot.executor.tell_time({.day = 4, .weekday = 2, .second = 34203}, robot.moment.utime);
  ASSERT_EQ(robot.executor.table().jobs.size(), 1U) << "the morning's tour, which nobody requested";
  JobRequest recorded;
  recorded.id = robot.moment.utime - JobQueue::kMaxAge - 1;
  recorded.stops = {{.place = "lab"}};
  EXPECT_EQ(robot.ask(recorded), "not echoed");
  EXPECT_EQ(robot.executor.table().jobs.size(), 1U);
}

TEST(JobQueue, RefusesWhatItCannotHold) {
  PretendedRobot robot;
  robot.moment.handled = "the motors are off";
  for (std::size_t i = 0; i < JobQueue::kMaxWaiting; ++i) {
    ASSERT_NE(robot.add(JobKind::kGo, {"lab"}), 0);
  }
  JobRequest request;
  request.stops = {{.place = "lab"}};
  EXPECT_THAT(robot.ask(request), HasSubstr("20 jobs wait already"));
}

TEST(JobQueue, ForgetsTheOldestOfThoseThatAreOver) {
  PretendedRobot robot;
  std::vector<std::int64_t> added;
  for (int i = 0; i < 15; ++i) {
    added.push_back(robot.add(JobKind::kGo, {"lab"}));
    EXPECT_EQ(robot.say(JobRequest::Action::kCancel, added.back()), "");
  }
  const std::vector<std::int64_t> left = ids(robot.executor.queue().in_order());
  ASSERT_EQ(left.size(), JobQueue::kMaxOver);
  EXPECT_EQ(left.front(), added.back());
  EXPECT_EQ(left.back(), added[5]);
}

}  // namespace
}  // namespace luminav
