#include "tests/evaluation/runs/job_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "drivers/simulator/geometry/random_stream.hpp"

namespace luminav {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

class Draw {
 public:
  Draw(const Scenario& scenario, const Building& building) : scenario_(scenario), random_(scenario.seed, "jobs") {
    for (const Place& place : building.places) {
      if (!scenario.dock || place.name != scenario.dock->place) {
        places_.push_back(place.name);
      }
    }
  }

  DrawnJobs run() {
    DrawnJobs drawn;
    const int tours = scenario_.jobs.count >= 10 && !scenario_.jobs.only_guides ? 2 : 0;
    for (int i = 0; i < tours; ++i) {
      drawn.tours.push_back(tour(i));
    }
    for (int i = 0; i < scenario_.jobs.count - tours; ++i) {
      drawn.jobs.push_back(job(i));
    }
    std::stable_sort(drawn.jobs.begin(), drawn.jobs.end(),
                     [](const PlannedJob& a, const PlannedJob& b) { return a.at < b.at; });
    for (int i = 0; i < scenario_.jobs.kills; ++i) {
      drawn.kills.push_back(random_.uniform(0.0, scenario_.jobs.time));
    }
    std::sort(drawn.kills.begin(), drawn.kills.end());
    return drawn;
  }

 private:
  std::vector<std::string> places(std::size_t count) {
    std::vector<std::string> chosen;
    while (chosen.size() < std::min(count, places_.size())) {
      const std::string& place = places_[random_.below(places_.size())];
      if (std::find(chosen.begin(), chosen.end(), place) == chosen.end()) {
        chosen.push_back(place);
      }
    }
    return chosen;
  }

  Tour tour(int index) {
    Tour tour;
    tour.name = fmt::format("tour {}", index + 1);
    tour.at = kMorning + static_cast<int>(random_.uniform(60.0, scenario_.jobs.time));
    for (const std::string& place : places(4)) {
      tour.stops.push_back({.place = place, .pause = 20.0, .text = fmt::format("This is {}.", place)});
    }
    return tour;
  }

  PlannedJob job(int index) {
    PlannedJob job;
    job.at = random_.uniform(0.0, scenario_.jobs.time);
    job.request.priority = random_.happens(0.2) ? 10 : 0;
    if (scenario_.jobs.only_guides) {
      set_stops(job, job_t::KIND_GUIDE, 1);
      set_visitor(job, index);
      return job;
    }
    switch (index % 5) {
      case 0:
      case 2:
        set_stops(job, job_t::KIND_GUIDE, 1);
        set_visitor(job, index / 5 * 2 + index % 5 / 2);
        break;
      case 1:
      case 3:
        set_stops(job, job_t::KIND_CARRY, 2);
        set_porters(job);
        break;
      default:
        index % 20 == 19 && scenario_.dock ? set_stops(job, job_t::KIND_HOME, 0) : set_stops(job, job_t::KIND_GO, 1);
    }
    return job;
  }

  void set_stops(PlannedJob& job, std::int8_t kind, std::size_t count) {
    job.request.kind = kind;
    for (const std::string& place : places(count)) {
      job_stop_t stop{};
      stop.place = place;
      job.request.stops.push_back(stop);
    }
    job.request.count = static_cast<std::int32_t>(job.request.stops.size());
  }

  /// Keeps up; slower than the robot; stops and comes after; turns away for good.
  void set_visitor(PlannedJob& job, int habit) {
    const double after = random_.uniform(2.0, 8.0);  // [m]
    const double pause = random_.uniform(15.0, 45.0);
    switch (habit % 4) {
      case 0:
        break;
      case 1:
        job.visitor.speed = random_.uniform(0.25, 0.4);
        break;
      case 2:
        job.visitor.stops_after = after;
        job.visitor.stops_for = pause;
        break;
      default:
        job.visitor.stops_after = after;
        job.visitor.leaves = true;
    }
  }

  /// Seven of ten carries are loaded and unloaded at once, at two somebody comes late, at one nobody does.
  void set_porters(PlannedJob& job) {
    for (double& seconds : job.handover) {
      seconds = random_.uniform(5.0, 40.0);
    }
    double& other = job.handover[random_.below(2)];
    const double late = random_.uniform(120.0, 480.0);
    const double kind = random_.uniform();
    job.request.on_timeout = static_cast<std::int8_t>(random_.below(3));
    if (kind > 0.9) {
      other = kNever;
      job.is_to_be_done = job.request.on_timeout == job_t::TIMEOUT_GO_ON;
    } else if (kind > 0.7) {
      other = late;
    }
  }

  const Scenario& scenario_;
  RandomStream random_;
  std::vector<std::string> places_;
};

}  // namespace

DrawnJobs draw_jobs(const Scenario& scenario, const Building& building) {
  return scenario.jobs.count > 0 ? Draw(scenario, building).run() : DrawnJobs{};
}

}  // namespace luminav
