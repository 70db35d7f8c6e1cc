#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <luminav/job_status_t.hpp>
#include <luminav/job_t.hpp>

#include "services/jobs/jobs_node.hpp"
#include "tests/node/planner/planner_world.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;
using Job = job_state_t;

/// The job service before the true planner: two rooms with a door between them.
class JobsAndPlanner {
 public:
  JobsAndPlanner() : jobs_(world.lcm, site()), inbox_(world.lcm) {
    inbox_.on(channels::kJobStatus, &JobsAndPlanner::on_job_status, this);
    world.run(3.0);
  }

  std::int64_t add(std::int8_t kind, const std::vector<std::string>& places) {
    job_t message{};
    message.kind = kind;
    for (const std::string& place : places) {
      job_stop_t stop{};
      stop.place = place;
      message.stops.push_back(stop);
    }
    message.count = static_cast<std::int32_t>(places.size());
    return send(message);
  }
  std::int64_t say(std::int8_t action, std::int64_t job, const std::string& word = "") {
    job_t message{};
    message.action = action;
    message.job = job;
    message.word = word;
    return send(message);
  }
  bool run_until(double seconds, std::int8_t state) {
    return world.run_until(seconds, [&] { return status.count > 0 && status.jobs[0].state == state; });
  }
  [[nodiscard]] double distance_to(double x, double y) const {
    return std::hypot(world.robot.x - x, world.robot.y - y);
  }

  PlannerWorld world;
  job_status_t status{};

 private:
  static JobsConfig site() {
    JobsConfig config;
    config.site = {.building = "two rooms",
                   .places = {{"desk", {2.0, 1.5, 0.0}, false}, {"shelf", {10.0, 4.0, 1.0}, true}}};
    return config;
  }
  std::int64_t send(job_t& message) {
    message.utime = world.utime;
    message.id = ++last_id_;
    world.lcm.publish(channels::kJob, &message);
    while (world.lcm.handleTimeout(0) > 0) {
    }
    return message.id;
  }
  void on_job_status(const job_status_t& message) { status = message; }

  JobsNode jobs_;
  Subscriber inbox_;
  std::int64_t last_id_ = 100;
};

TEST(JobsWithPlanner, CarryFromRoomToRoom) {
  JobsAndPlanner both;
  const std::int64_t job = both.add(job_t::KIND_CARRY, {"desk", "shelf"});
  ASSERT_TRUE(both.run_until(60.0, Job::STATE_AT_STOP));
  EXPECT_LT(both.distance_to(2.0, 1.5), 0.2);
  both.say(job_t::ACTION_CONFIRM, job, "loaded");
  both.world.run(5.0);
  ASSERT_TRUE(both.run_until(60.0, Job::STATE_AT_STOP));
  EXPECT_LT(both.distance_to(10.0, 4.0), 0.2);
  both.say(job_t::ACTION_CONFIRM, job, "unloaded");
  EXPECT_TRUE(both.run_until(2.0, Job::STATE_DONE));
}

TEST(JobsWithPlanner, OutlastAPauseByThePage) {
  JobsAndPlanner both;
  both.add(job_t::KIND_GO, {"shelf"});
  both.world.run(5.0);
  both.world.act(both.world.status.goal_id + 5, goal_t::ACTION_PAUSE);
  both.world.run(10.0);
  EXPECT_THAT(both.status.jobs[0].sentence, HasSubstr("paused on the way to shelf"));
  both.world.act(both.world.status.goal_id + 5, goal_t::ACTION_RESUME);
  EXPECT_TRUE(both.run_until(60.0, Job::STATE_DONE));
}

TEST(JobsWithPlanner, StandWhenTheirJobIsCancelled) {
  JobsAndPlanner both;
  const std::int64_t job = both.add(job_t::KIND_GO, {"shelf"});
  both.world.run(5.0);
  both.say(job_t::ACTION_CANCEL, job);
  both.world.run(1.0);
  EXPECT_EQ(both.world.status.state, navigation_status_t::STATE_CANCELLED);
  const Pose2 stands = both.world.robot;
  both.world.run(5.0);
  EXPECT_LT(both.distance_to(stands.x, stands.y), 0.01);
}

TEST(JobsWithPlanner, AskAboutAClosedDoorAndGoOnWhenItIsOpened) {
  JobsAndPlanner both;
  both.world.obstacle(6.0, 2.6, 6.4, 3.8);
  const std::int64_t job = both.add(job_t::KIND_GO, {"shelf"});
  ASSERT_TRUE(both.run_until(600.0, Job::STATE_ASKING));
  EXPECT_THAT(both.status.jobs[0].question, HasSubstr("on the way to shelf"));
  ASSERT_GT(both.status.jobs[0].answer_count, 0);
  EXPECT_EQ(both.status.jobs[0].answers[0], "opened");
  both.world.run(20.0);
  EXPECT_EQ(both.status.jobs[0].state, Job::STATE_ASKING);
  both.world.obstacle(6.0, 2.6, 6.4, 3.8, false);
  both.say(job_t::ACTION_ANSWER, job, "opened");
  EXPECT_TRUE(both.run_until(60.0, Job::STATE_DONE)) << both.status.jobs[0].sentence;
}

TEST(JobsWithPlanner, GiveTheRobotToWhoeverSendsItElsewhereAndTakeItBackWhenToldSo) {
  JobsAndPlanner both;
  const std::int64_t job = both.add(job_t::KIND_GO, {"shelf"});
  both.world.run(4.0);
  both.world.go(both.world.status.goal_id + 5, 3.0, 5.0);
  both.world.run(30.0);
  EXPECT_LT(both.distance_to(3.0, 5.0), 0.2);
  EXPECT_EQ(both.status.jobs[0].state, Job::STATE_ASKING);
  both.say(job_t::ACTION_ANSWER, job, "go on");
  EXPECT_TRUE(both.run_until(60.0, Job::STATE_DONE));
}

}  // namespace
}  // namespace luminav
