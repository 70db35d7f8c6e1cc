#include "services/jobs/jobs_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <luminav/camera_image_t.hpp>
#include <luminav/goal_t.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/speed_limit_t.hpp>
#include <memory>

#include "services/common/process/channels.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

JobsConfig laboratory(const std::filesystem::path& state = {}) {
  JobsConfig config;
  config.site = {.building = "laboratory",
                 .places = {{"lab", {1.0, 2.0, 0.0}, false}, {"office", {8.0, 2.0, 1.0}, true}}};
  config.state_folder = state;
  config.boot = "boot";
  return config;
}

/// The job service with a planner that takes up what it is asked, and a robot that says so.
class JobsWorld {
 public:
  explicit JobsWorld(const JobsConfig& config = laboratory()) : config_(config), inbox_(lcm) {
    start();
    inbox_.on(channels::kGoal, &JobsWorld::on_goal, this);
    inbox_.on(channels::kJobStatus, &JobsWorld::on_job_status, this);
    inbox_.on(channels::kSpeedLimit, &JobsWorld::on_speed_limit, this);
  }

  void start() { node = std::make_unique<JobsNode>(lcm, config_); }

  job_t request(std::int8_t action, std::int64_t id) {
    job_t message{};
    message.utime = utime;
    message.id = id;
    message.action = action;
    return message;
  }
  void send(const job_t& message) {
    lcm.publish(channels::kJob, &message);
    deliver();
  }
  void carry(std::int64_t id) {
    job_t message = request(job_t::ACTION_ADD, id);
    message.kind = job_t::KIND_CARRY;
    for (const char* place : {"lab", "office"}) {
      job_stop_t stop{};
      stop.place = place;
      message.stops.push_back(stop);
    }
    message.count = 2;
    send(message);
  }
  void confirm(std::int64_t id, std::int64_t job, const std::string& word) {
    job_t message = request(job_t::ACTION_CONFIRM, id);
    message.job = job;
    message.word = word;
    send(message);
  }

  void run(double seconds) {
    for (double t = 0.0; t < seconds; t += 0.1) {
      utime += 100'000;
      robot_status_t robot{};
      robot.utime = utime;
      robot.connected = robot.motors_enabled = 1;
      robot.battery_voltage = 13.0;
      lcm.publish(channels::kRobotStatus, &robot);
      navigation.utime = utime;
      lcm.publish(channels::kNavigationStatus, &navigation);
      deliver();
    }
  }
  void arrive() {
    run(3.0);
    navigation.state = navigation_status_t::STATE_ARRIVED;
    run(1.0);
  }
  void deliver() {
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  [[nodiscard]] std::string objection(std::int64_t id) const {
    for (std::size_t i = 0; i < status.echo_ids.size(); ++i) {
      if (status.echo_ids[i] == id) {
        return status.objections[i];
      }
    }
    return "not echoed";
  }

  lcm::LCM lcm{"memq://"};
  std::unique_ptr<JobsNode> node;
  std::int64_t utime = 1'000'000'000;
  navigation_status_t navigation{};
  std::vector<goal_t> goals;  // that the planner took up
  job_status_t status{};
  int statuses = 0;
  std::vector<speed_limit_t> limits;

 private:
  void on_goal(const goal_t& goal) {
    if (goal.id > navigation.goal_id) {
      navigation.goal_id = goal.id;
      goals.push_back(goal);
      navigation.state = goal.action == goal_t::ACTION_CANCEL ? navigation_status_t::STATE_CANCELLED
                                                              : navigation_status_t::STATE_FOLLOWING;
      if (goal.action == goal_t::ACTION_GO) {
        navigation.has_target = 1;
        navigation.x = goal.poses[0].x;
        navigation.y = goal.poses[0].y;
        navigation.has_theta = goal.poses[0].has_theta;
      }
    }
  }
  void on_speed_limit(const speed_limit_t& message) { limits.push_back(message); }
  void on_job_status(const job_status_t& message) {
    status = message;
    ++statuses;
  }

  JobsConfig config_;
  Subscriber inbox_;
};

TEST(JobsNode, CarriesFromPlaceToPlace) {
  JobsWorld world;
  world.run(3.0);
  world.carry(500);
  EXPECT_EQ(world.objection(500), "");
  world.arrive();
  ASSERT_THAT(world.goals, SizeIs(1));
  EXPECT_EQ(world.goals[0].poses[0].place, "lab");
  ASSERT_EQ(world.status.count, 1);
  EXPECT_EQ(world.status.jobs[0].state, job_state_t::STATE_AT_STOP);
  EXPECT_EQ(world.status.jobs[0].waits_for, "loaded");
  world.confirm(501, 500, "loaded");
  world.arrive();
  ASSERT_THAT(world.goals, SizeIs(2));
  EXPECT_EQ(world.goals[1].poses[0].x, 8.0);
  world.confirm(502, 500, "unloaded");
  EXPECT_EQ(world.status.jobs[0].state, job_state_t::STATE_DONE);
  EXPECT_EQ(world.status.jobs[0].position, -1);
}

TEST(JobsNode, SpeaksOnceASecondAndAtOnceWhenSomethingChanges) {
  JobsWorld world;
  world.run(10.0);
  EXPECT_GE(world.statuses, 9);
  EXPECT_LE(world.statuses, 12);
  const int before = world.statuses;
  world.carry(500);
  EXPECT_EQ(world.statuses, before + 1);
}

TEST(JobsNode, TakesRequestsWithoutARobotAndSaysSo) {
  JobsWorld world;
  world.carry(500);
  EXPECT_EQ(world.objection(500), "");
  world.node->tell_time({});
  world.node->tell_time({});
  world.deliver();
  EXPECT_EQ(world.status.count, 1);
  EXPECT_TRUE(world.goals.empty());
}

TEST(JobsNode, DropsWhatStandsForNothing) {
  JobsWorld world;
  job_t message = world.request(7, 500);
  world.send(message);
  message = world.request(job_t::ACTION_ADD, 501);
  message.kind = 9;
  world.send(message);
  message = world.request(job_t::ACTION_ADD, -5);
  world.send(message);
  const std::vector<std::uint8_t> noise(40, 0xff);
  world.lcm.publish(channels::kJob, noise.data(), static_cast<unsigned>(noise.size()));
  world.deliver();
  EXPECT_EQ(world.node->health().dropped_inputs, 4);
  EXPECT_EQ(world.status.count, 0);
}

TEST(JobsNode, FitsIntoOneDatagramHoweverMuchIsSaid) {
  JobsWorld world;
  world.run(1.0);
  const std::string much(200, 'x');
  for (int i = 0; i < 60; ++i) {
    job_t message = world.request(job_t::ACTION_ADD, 500 + i);
    message.kind = job_t::KIND_TOUR;
    message.sender = std::string(5000, 's');
    for (int stop = 0; stop < 20; ++stop) {
      message.stops.push_back({"", 1e3 + stop, -1e3, 0, 0.0, 3600.0, much});
    }
    message.count = 20;
    world.send(message);
    if (i % 2 == 0) {
      job_t cancel = world.request(job_t::ACTION_CANCEL, 1000 + i);
      cancel.job = 500 + i;
      world.send(cancel);
    }
  }
  JobsFile jobs;
  for (std::size_t i = 0; i < kMaxTours; ++i) {
    jobs.tours.push_back({.name = std::to_string(i) + std::string(58, 't')});
  }
  world.node->set_jobs(jobs);
  world.deliver();
  EXPECT_EQ(world.status.count, 30);
  EXPECT_EQ(world.status.tour_count, 50);
  EXPECT_LT(world.status.getEncodedSize(), 65'000);
}

TEST(JobsNode, LimitsTheSpeedWhileItGuidesAndNotElse) {
  JobsWorld world;
  world.run(3.0);
  world.carry(500);
  world.run(3.0);
  EXPECT_TRUE(world.limits.empty());
  job_t cancel = world.request(job_t::ACTION_CANCEL, 501);
  cancel.job = 500;
  world.send(cancel);
  job_t guide = world.request(job_t::ACTION_ADD, 502);
  guide.kind = job_t::KIND_GUIDE;
  guide.stops.resize(1);
  guide.stops[0].place = "lab";
  guide.count = 1;
  world.send(guide);
  world.run(5.0);
  ASSERT_GT(world.limits.size(), 5U);
  EXPECT_DOUBLE_EQ(world.limits.back().max_speed, 0.4);
  EXPECT_EQ(world.limits.back().sender, "jobs");
  EXPECT_LT(world.utime - world.limits.back().utime, 300'000) << "it is repeated";
  world.navigation.state = navigation_status_t::STATE_ARRIVED;
  world.run(1.0);
  const std::size_t told = world.limits.size();
  world.run(2.0);
  EXPECT_EQ(world.limits.size(), told);
}

TEST(JobsNode, KeepsAPictureOfAStopThatWantsOne) {
  const TemporaryFolder folder;
  JobsWorld world(laboratory(folder.path()));
  JobsFile jobs;
  jobs.tours = {{.name = "round", .stops = {{.place = "lab", .photo = true}, {.place = "office"}}}};
  world.node->set_jobs(jobs);
  const auto take_picture = [&] {
    camera_image_t image{};
    image.utime = world.utime;
    image.format = camera_image_t::FORMAT_JPEG;
    image.data = {1, 2, 3};
    image.size = 3;
    world.lcm.publish(channels::kCameraImage, &image);
    world.deliver();
  };
  const auto count = [&] {
    std::size_t files = 0;
    const auto photos = folder.path() / "photos";
    if (std::filesystem::exists(photos)) {
      for (const auto& entry : std::filesystem::directory_iterator(photos)) {
        files += entry.path().extension() == ".jpg" ? 1 : 0;
      }
    }
    return files;
  };
  job_t tour = world.request(job_t::ACTION_ADD, 500);
  tour.kind = job_t::KIND_TOUR;
  tour.tour = "round";
  world.run(3.0);
  world.send(tour);
  world.run(3.0);
  take_picture();
  EXPECT_FALSE(world.node->wants_pictures()) << "on the way";
  world.navigation.state = navigation_status_t::STATE_ARRIVED;
  world.run(0.6);
  EXPECT_TRUE(world.node->wants_pictures()) << "it waits for one, although the stop has no pause";
  EXPECT_EQ(count(), 0U);
  take_picture();
  take_picture();
  EXPECT_EQ(count(), 1U);
  world.run(1.0);
  EXPECT_FALSE(world.node->wants_pictures());
  EXPECT_EQ(world.status.jobs[0].stop, 1);
}

TEST(JobsNode, GoesOnWithoutAPictureWhereTheCameraIsSilent) {
  JobsWorld world;
  JobsFile jobs;
  jobs.tours = {{.name = "round", .stops = {{.place = "lab", .photo = true}, {.place = "office"}}}};
  world.node->set_jobs(jobs);
  job_t tour = world.request(job_t::ACTION_ADD, 500);
  tour.kind = job_t::KIND_TOUR;
  tour.tour = "round";
  world.run(3.0);
  world.send(tour);
  world.arrive();
  EXPECT_EQ(world.status.jobs[0].stop, 0);
  world.run(4.0);
  EXPECT_EQ(world.status.jobs[0].stop, 1);
}

TEST(JobsNode, GoesOnAfterACrashAndAsksAfterAnOrderlyEnd) {
  const TemporaryFolder folder;
  JobsWorld world(laboratory(folder.path()));
  world.run(3.0);
  world.carry(500);
  world.run(3.0);
  ASSERT_THAT(world.goals, SizeIs(1));
  world.start();  // as after a crash: nobody told it to end
  world.arrive();
  EXPECT_THAT(world.goals, SizeIs(1));
  EXPECT_EQ(world.status.jobs[0].state, job_state_t::STATE_AT_STOP);
  world.confirm(501, 500, "loaded");
  world.run(3.0);
  ASSERT_THAT(world.goals, SizeIs(2));
  world.node->end();
  world.deliver();
  ASSERT_THAT(world.goals, SizeIs(3));
  EXPECT_EQ(world.goals[2].action, goal_t::ACTION_CANCEL) << "nothing drives when it ends";
  world.start();
  world.run(10.0);
  EXPECT_THAT(world.goals, SizeIs(3)) << "nothing moves by itself";
  EXPECT_EQ(world.status.jobs[0].state, job_state_t::STATE_ASKING);
  EXPECT_THAT(world.status.jobs[0].question, HasSubstr("the job service ended in order"));
}

TEST(JobsNode, TellsWhoAsksWhenTheDiskTakesNothing) {
  const TemporaryFolder folder;
  folder.write("state", "a file where a folder should be");
  JobsWorld world(laboratory(folder.path() / "state"));
  world.run(1.0);
  world.carry(500);
  EXPECT_THAT(world.objection(500), HasSubstr("it cannot be kept"));
  EXPECT_EQ(world.status.count, 0);
  EXPECT_TRUE(world.node->health().degraded);
}

}  // namespace
}  // namespace luminav
