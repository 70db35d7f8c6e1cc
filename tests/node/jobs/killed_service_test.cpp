#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <luminav/goal_t.hpp>
#include <luminav/job_status_t.hpp>
#include <new>
#include <string_view>

#include "services/common/process/channels.hpp"
#include "services/jobs/jobs_node.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

constexpr int kJobs = 10;

/// What outlives the job service: ten people who repeat their requests until they are echoed, and a planner.
struct Survivors {
  std::int64_t utime = 1'000'000'000;
  std::array<bool, kJobs> echoed{};
  std::array<int, kJobs> goals{};  // that the planner took up, by the x of their target
  std::int64_t goal_id = 0;
  int state = navigation_status_t::STATE_IDLE;
  double x = 0.0;
  int steps_left = 0;  // until it arrives
  int done = 0;        // jobs that JOB_STATUS calls done
  int jobs = 0;        // all that it tells of
};

void hear_goal(Survivors& world, const goal_t& goal) {
  if (goal.id > world.goal_id && goal.action == goal_t::ACTION_GO) {
    world.goal_id = goal.id;
    world.x = goal.poses[0].x;
    ++world.goals[static_cast<std::size_t>(goal.poses[0].x)];
    world.state = navigation_status_t::STATE_FOLLOWING;
    world.steps_left = 5;
  }
}

void hear_jobs(Survivors& world, const job_status_t& status) {
  for (const std::int64_t id : status.echo_ids) {
    world.echoed[static_cast<std::size_t>(id - 100)] = true;
  }
  world.jobs = status.count;
  world.done = 0;
  for (const job_state_t& job : status.jobs) {
    world.done += job.state == job_state_t::STATE_DONE ? 1 : 0;
  }
}

Survivors* g_world = nullptr;

}  // namespace
}  // namespace luminav

// Calls to the disk until the process is killed; below 0 = never. The linker leads write, fsync and rename here, and
// lcm_publish: what the service has said is heard before it can be killed.
static int g_calls_left = -1;

static void die_at_the_last() {
  if (g_calls_left == 0) {
    kill(getpid(), SIGKILL);
  }
  --g_calls_left;
}

extern "C" {
ssize_t __real_write(int file, const void* bytes, size_t count);
int __real_fsync(int file);
int __real_rename(const char* from, const char* to);
ssize_t __wrap_write(int file, const void* bytes, size_t count);
int __wrap_fsync(int file);
int __wrap_rename(const char* from, const char* to);
ssize_t __wrap_write(int file, const void* bytes, size_t count) {
  die_at_the_last();
  return __real_write(file, bytes, count);
}
int __wrap_fsync(int file) {
  die_at_the_last();
  return __real_fsync(file);
}
int __wrap_rename(const char* from, const char* to) {
  die_at_the_last();
  return __real_rename(from, to);
}
int __real_lcm_publish(lcm_t* network, const char* channel, const void* bytes, unsigned size);
int __wrap_lcm_publish(lcm_t* network, const char* channel, const void* bytes, unsigned size);
int __wrap_lcm_publish(lcm_t* network, const char* channel, const void* bytes, unsigned size) {
  if (luminav::g_world != nullptr && channel == std::string_view(luminav::channels::kGoal)) {
    luminav::goal_t goal{};
    goal.decode(bytes, 0, static_cast<int>(size));
    luminav::hear_goal(*luminav::g_world, goal);
  } else if (luminav::g_world != nullptr && channel == std::string_view(luminav::channels::kJobStatus)) {
    luminav::job_status_t status{};
    status.decode(bytes, 0, static_cast<int>(size));
    luminav::hear_jobs(*luminav::g_world, status);
  }
  return __real_lcm_publish(network, channel, bytes, size);
}
}

namespace luminav {
namespace {

/// One life of the job service among them, on a network of its own.
class Life {
 public:
  Life(Survivors& world, const JobsConfig& config) : world_(world), node_(lcm_, config) { g_world = &world; }

  /// Until all jobs are done, or so many tenths of a second.
  void run(int steps) {
    for (int i = 0; i < steps && world_.done < kJobs; ++i) {
      world_.utime += 100'000;
      say_status();
      say_navigation();
      request();
      while (lcm_.handleTimeout(0) > 0) {
      }
    }
  }

 private:
  void request() {
    for (std::size_t i = 0; i < kJobs; ++i) {
      if (!world_.echoed[i]) {
        job_t job{};
        job.utime = world_.utime;
        job.id = 100 + static_cast<std::int64_t>(i);
        job_stop_t stop{};
        stop.x = static_cast<double>(i);
        job.stops.push_back(stop);
        job.count = 1;
        lcm_.publish(channels::kJob, &job);
      }
    }
  }
  void say_status() {
    robot_status_t status{};
    status.utime = world_.utime;
    status.connected = status.motors_enabled = 1;
    status.battery_voltage = 13.0;
    lcm_.publish(channels::kRobotStatus, &status);
  }
  void say_navigation() {
    if (world_.steps_left > 0 && --world_.steps_left == 0) {
      world_.state = navigation_status_t::STATE_ARRIVED;
    }
    navigation_status_t status{};
    status.utime = world_.utime;
    status.goal_id = world_.goal_id;
    status.state = static_cast<std::int8_t>(world_.state);
    status.has_target = world_.goal_id != 0;
    status.x = world_.x;
    lcm_.publish(channels::kNavigationStatus, &status);
  }
  Survivors& world_;
  lcm::LCM lcm_{"memq://"};
  JobsNode node_;
};

/// Lives a life in a process of its own, which dies at the given call to the disk. Returns whether it was killed.
bool live(Survivors& world, const JobsConfig& config, int calls) {
  const pid_t child = fork();
  if (child == 0) {
    g_calls_left = calls;
    Life(world, config).run(2000);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

TEST(KilledJobService, LosesAndDoublesNoJobWhereverItIsKilled) {
  void* shared = mmap(nullptr, sizeof(Survivors), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  int kills = 0;
  int worlds = 0;
  while (kills < 50) {
    ++worlds;
    ASSERT_LT(worlds, 50) << "it is never killed";
    const TemporaryFolder folder;
    JobsConfig config;
    config.site.building = "laboratory";
    config.state_folder = folder.path();
    config.boot = "boot";
    auto& world = *new (shared) Survivors;
    // at least two writes of the table a life, so that each comes farther than the one before
    for (int life = 0; live(world, config, 9 + (7 * kills) % 13); ++life) {
      ++kills;
      ASSERT_LT(life, 200) << "it never comes to an end";
    }
    EXPECT_EQ(world.done, kJobs);
    EXPECT_EQ(world.jobs, kJobs);
    for (std::size_t i = 0; i < kJobs; ++i) {
      EXPECT_TRUE(world.echoed[i]);
      EXPECT_EQ(world.goals[i], 1) << "job " << i << ", after " << kills << " kills";
    }
  }
  munmap(shared, sizeof(Survivors));
}

}  // namespace
}  // namespace luminav
