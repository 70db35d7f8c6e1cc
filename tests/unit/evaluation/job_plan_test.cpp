#include "tests/evaluation/runs/job_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace luminav {
namespace {

Scenario eight_hours(std::uint64_t seed) {
  Scenario scenario;
  scenario.seed = seed;
  scenario.jobs = {60, 20'000.0, 5};
  scenario.dock = Dock{"dock", {}};
  return scenario;
}

Building building() {
  Building building;
  for (const char* name : {"dock", "lift", "lab", "office", "hall"}) {
    building.places.push_back({name, {}, true});
  }
  return building;
}

TEST(DrawnJobs, AreSixtyOfAllKinds) {
  const DrawnJobs drawn = draw_jobs(eight_hours(1), building());
  EXPECT_EQ(drawn.jobs.size() + drawn.tours.size(), 60U);
  EXPECT_EQ(drawn.tours.size(), 2U);
  EXPECT_EQ(drawn.kills.size(), 5U);
  std::map<int, int> kinds;
  std::map<std::string, int> habits;
  double last = 0.0;
  for (const PlannedJob& job : drawn.jobs) {
    ++kinds[job.request.kind];
    EXPECT_GE(job.at, last);
    last = job.at;
    for (const job_stop_t& stop : job.request.stops) {
      EXPECT_NE(stop.place, "dock");
    }
    if (job.request.kind == job_t::KIND_GUIDE) {
      const VisitorHabit& habit = job.visitor;
      ++habits[habit.leaves                       ? "leaves"
               : std::isfinite(habit.stops_after) ? "stops"
               : habit.speed < 0.5                ? "slower"
                                                  : "keeps up"];
    }
  }
  EXPECT_EQ(kinds[job_t::KIND_GUIDE], 24);
  EXPECT_EQ(kinds[job_t::KIND_CARRY], 23);
  EXPECT_EQ(kinds[job_t::KIND_HOME], 2);
  EXPECT_EQ(habits.size(), 4U);
}

TEST(DrawnJobs, AreGuidesAloneWithEachHabitInTurn) {
  Scenario scenario = eight_hours(1);
  scenario.jobs.count = 12;
  scenario.jobs.only_guides = true;
  const DrawnJobs drawn = draw_jobs(scenario, building());
  ASSERT_EQ(drawn.jobs.size(), 12U);
  EXPECT_TRUE(drawn.tours.empty());
  int leave = 0;
  for (const PlannedJob& job : drawn.jobs) {
    EXPECT_EQ(job.request.kind, job_t::KIND_GUIDE);
    EXPECT_EQ(job.request.stops.size(), 1U);
    leave += job.visitor.leaves ? 1 : 0;
  }
  EXPECT_EQ(leave, 3);
}

TEST(DrawnJobs, FollowFromTheSeed) {
  const DrawnJobs one = draw_jobs(eight_hours(1), building());
  const DrawnJobs again = draw_jobs(eight_hours(1), building());
  const DrawnJobs other = draw_jobs(eight_hours(2), building());
  EXPECT_EQ(one.jobs[7].at, again.jobs[7].at);
  EXPECT_EQ(one.kills, again.kills);
  EXPECT_NE(one.kills, other.kills);
}

TEST(DrawnJobs, EndInVainWhereNobodyLoadsAndTheRobotMayNotGoOn) {
  int never = 0;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    for (const PlannedJob& job : draw_jobs(eight_hours(seed), building()).jobs) {
      if (job.request.kind == job_t::KIND_CARRY) {
        const bool is_served = std::isfinite(job.handover[0]) && std::isfinite(job.handover[1]);
        never += is_served ? 0 : 1;
        EXPECT_EQ(job.is_to_be_done, is_served || job.request.on_timeout == job_t::TIMEOUT_GO_ON);
      }
    }
  }
  EXPECT_NEAR(never, 0.1 * 19 * 23, 20);
}

}  // namespace
}  // namespace luminav
