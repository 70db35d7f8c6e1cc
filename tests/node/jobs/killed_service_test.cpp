#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <luminav/goal_t.hpp>
#include <luminav/job_status_t.hpp>
#include <new>
#include <string>
#include <string_view>

#include "services/common/process/channels.hpp"
#include "services/jobs/jobs_node.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

constexpr int kJobs = 10;

/// What outlives the job service: ten people who repeat their requests until they are echoed, and a planner. Every
/// second job is a carry, from x to the same x with a y of 1.
struct Survivors {
  std::int64_t utime = 1'000'000'000;
  std::array<bool, kJobs> echoed{};
  std::array<std::int64_t, kJobs> words{};  // ids of confirmations and answers that are not echoed yet; 0 = none
  std::array<int, kJobs> last{};            // states
  std::array<int, kJobs> ends{};            // how often each came to its end
  std::array<int, 2 * kJobs> goals{};       // that the planner took up, by the x and y of their target
  std::int64_t last_id = 1000;
  std::int64_t goal_id = 0;
  int state = navigation_status_t::STATE_IDLE;
  double x = 0.0;
  double y = 0.0;
  int steps_left = 0;  // until it arrives
  int done = 0;        // jobs that JOB_STATUS calls done
  int jobs = 0;        // all that it tells of
};

void hear_goal(Survivors& world, const goal_t& goal) {
  if (goal.id > world.goal_id && goal.action == goal_t::ACTION_GO) {
    world.goal_id = goal.id;
    world.x = goal.poses[0].x;
    world.y = goal.poses[0].y;
    ++world.goals[static_cast<std::size_t>(world.x + kJobs * world.y)];
    world.state = navigation_status_t::STATE_FOLLOWING;
    world.steps_left = 5;
  }
}

void hear_jobs(Survivors& world, const job_status_t& status) {
  for (const std::int64_t id : status.echo_ids) {
    if (id < 1000) {
      world.echoed[static_cast<std::size_t>(id - 100)] = true;
    }
    std::replace(world.words.begin(), world.words.end(), id, std::int64_t{0});
  }
  world.jobs = status.count;
  world.done = 0;
  for (const job_state_t& job : status.jobs) {
    const auto i = static_cast<std::size_t>(job.id - 100);
    const bool is_done = job.state == job_state_t::STATE_DONE;
    world.done += is_done ? 1 : 0;
    world.ends[i] += is_done && world.last[i] != job.state ? 1 : 0;
    world.last[i] = job.state;
    if (world.words[i] == 0 && (!job.waits_for.empty() || job.answer_count > 0)) {
      world.words[i] = ++world.last_id;
    }
  }
}

Survivors* g_world = nullptr;

}  // namespace
}  // namespace luminav

// Calls to the disk until the process is killed; below 0 = never. The linker leads write, fsync and rename here, and
// lcm_publish: what the service has said is heard before it can be killed.
static int g_calls_left = -1;
static std::string g_renamed;  // the file that was written last

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
// What a folder has when it is synchronized is what a power cut leaves.
int __wrap_fsync(int file) {
  die_at_the_last();
  const int result = __real_fsync(file);
  struct stat status {};
  if (fstat(file, &status) == 0 && S_ISDIR(status.st_mode) && !g_renamed.empty()) {
    std::filesystem::copy_file(g_renamed, g_renamed + ".durable", std::filesystem::copy_options::overwrite_existing);
  }
  return result;
}
int __wrap_rename(const char* from, const char* to) {
  die_at_the_last();
  g_renamed = to;
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
        job.kind = i % 2 == 0 ? job_t::KIND_GO : job_t::KIND_CARRY;
        job.count = i % 2 == 0 ? 1 : 2;
        for (int j = 0; j < job.count; ++j) {
          job_stop_t stop{};
          stop.x = static_cast<double>(i);
          stop.y = j;
          job.stops.push_back(stop);
        }
        lcm_.publish(channels::kJob, &job);
      }
      if (world_.words[i] != 0) {
        job_t word{};
        word.utime = world_.utime;
        word.id = world_.words[i];
        word.job = 100 + static_cast<std::int64_t>(i);
        word.action = world_.last[i] == job_state_t::STATE_ASKING ? job_t::ACTION_ANSWER : job_t::ACTION_CONFIRM;
        word.word = word.action == job_t::ACTION_ANSWER ? "go on" : "";
        lcm_.publish(channels::kJob, &word);
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
    status.y = world_.y;
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

using Mend = std::function<void(const std::filesystem::path& table, JobsConfig& config, Survivors& world)>;
using Judge = std::function<void(const Survivors& world)>;

/// Kills the service again and again, in as many worlds as it takes for fifty kills, each time after at least so many
/// calls to the disk that it comes farther than the time before. `mend` does to the world what else comes with a kill;
/// `judge` is told how each world ended.
void kill_fifty_times(int min_calls, const Mend& mend, const Judge& judge) {
  void* shared = mmap(nullptr, sizeof(Survivors), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  int kills = 0;
  for (int worlds = 0; kills < 50; ++worlds) {
    ASSERT_LT(worlds, 50) << "it is never killed";
    const TemporaryFolder folder;
    JobsConfig config;
    config.site.building = "laboratory";
    config.state_folder = folder.path();
    config.boot = "boot";
    auto& world = *new (shared) Survivors;
    for (int life = 0; live(world, config, min_calls + (7 * kills) % 13); ++life) {
      ++kills;
      ASSERT_LT(life, 200) << "it never comes to an end";
      mend(folder.path() / "jobs.json", config, world);
    }
    EXPECT_EQ(world.done, kJobs);
    EXPECT_EQ(world.jobs, kJobs);
    for (std::size_t i = 0; i < kJobs; ++i) {
      EXPECT_TRUE(world.echoed[i]);
      EXPECT_EQ(world.ends[i], 1) << "job " << i << ", after " << kills << " kills";
    }
    judge(world);
  }
  munmap(shared, sizeof(Survivors));
}

TEST(KilledJobService, LosesAndDoublesNoJobWhereverItIsKilled) {
  kill_fifty_times(
      9, [](const std::filesystem::path&, JobsConfig&, Survivors&) {},
      [](const Survivors& world) {
        for (std::size_t i = 0; i < world.goals.size(); ++i) {
          const bool is_stop = i < kJobs || i % 2 != 0;
          EXPECT_EQ(world.goals[i], is_stop ? 1 : 0) << "goal " << i;
        }
      });
}

// What was not synchronized is gone, the planner has forgotten its goal, and the machine was started anew: people are
// asked whether each job is still to be done.
TEST(KilledJobService, LosesAndDoublesNoJobWhenThePowerIsCutBetweenTwoWrites) {
  int cuts = 0;
  const auto restart = [&](const std::filesystem::path& table, JobsConfig& config, Survivors& world) {
    const std::filesystem::path durable = table.string() + ".durable";
    std::filesystem::remove(table);
    if (std::filesystem::exists(durable)) {
      std::filesystem::copy_file(durable, table);
    }
    config.boot = fmt::format("boot {}", ++cuts);
    world.state = navigation_status_t::STATE_IDLE;
    world.goal_id = 0;
    world.steps_left = 0;
  };
  kill_fifty_times(70, restart, [](const Survivors&) {});
  EXPECT_GE(cuts, 50);
}

}  // namespace
}  // namespace luminav
