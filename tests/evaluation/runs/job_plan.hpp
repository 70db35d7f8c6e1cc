#pragma once

#include <array>
#include <luminav/job_t.hpp>
#include <vector>

#include "drivers/simulator/people/visitor.hpp"
#include "drivers/simulator/world/scenario.hpp"
#include "services/common/building/building.hpp"
#include "services/jobs/tour_schedule.hpp"

namespace luminav {

/// A job that somebody orders, and what the people of it do.
struct PlannedJob {
  double at = 0.0;                   // [s] since the start
  job_t request{};                   // all but stamp and id
  VisitorHabit visitor{};            // of a guide
  std::array<double, 2> handover{};  // [s] of a carry, until "loaded" and "unloaded" is said; infinite = never
  bool is_to_be_done = true;         // else it has to end as given up; of a guide its visitor decides
};

/// All that is drawn of a scenario's jobs.
struct DrawnJobs {
  std::vector<PlannedJob> jobs{};  // by time
  std::vector<Tour> tours{};       // that start by themselves
  std::vector<double> kills{};     // [s] since the start, of the job service, by time
};

/// Time of day [s] at which a run begins.
inline constexpr int kMorning = 8 * 3600;

/// The same for a scenario with the same seed: of `count` jobs two are tours, where there are ten or more, two fifths
/// guides with each habit in turn, two fifths carries, the others go somewhere or home.
DrawnJobs draw_jobs(const Scenario& scenario, const Building& building);

}  // namespace luminav
