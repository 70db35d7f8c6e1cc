// What people ask of the job service: new jobs, confirmations, answers.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "services/jobs/job_executor.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxStops = kMaxTourStops;
constexpr std::size_t kMaxText = kMaxTourText;  // of what is said at a stop: all jobs fit into one datagram
constexpr double kFarthest = 10'000.0;          // [m]
constexpr double kLongestPause = kLongestTourPause;
constexpr double kBeforeHome = 0.7;  // [m] from there straight in

std::string say(std::int64_t id) {
  return fmt::format("job {}", id);
}

/// How many stops a person must name.
std::pair<std::size_t, std::size_t> stops_wanted(const JobRequest& request) {
  switch (request.kind) {
    case JobKind::kGo:
    case JobKind::kGuide:
      return {1, 1};
    case JobKind::kCarry:
      return {2, 2};
    case JobKind::kTour:
      return request.tour.empty() ? std::pair<std::size_t, std::size_t>{1, kMaxStops}
                                  : std::pair<std::size_t, std::size_t>{0, 0};
    case JobKind::kHome:
      break;
  }
  return {0, 0};
}

bool is_sound(const JobStop& stop) {
  const auto lies_within = [](double value, double farthest) {
    return std::isfinite(value) && std::abs(value) <= farthest;
  };
  return lies_within(stop.pose.x, kFarthest) && lies_within(stop.pose.y, kFarthest) &&
         lies_within(stop.pose.theta, 100.0) && lies_within(stop.pause, kLongestPause) && stop.pause >= 0.0 &&
         stop.text.size() <= kMaxText && stop.place.size() <= kMaxText;
}

}  // namespace

const Place* JobExecutor::place_called(const std::string& name) const {
  const auto found =
      std::find_if(site_.places.begin(), site_.places.end(), [&](const Place& p) { return p.name == name; });
  return found == site_.places.end() ? nullptr : &*found;
}

const Tour* JobExecutor::tour_called(const std::string& name) const {
  const auto found =
      std::find_if(site_.jobs.tours.begin(), site_.jobs.tours.end(), [&](const Tour& t) { return t.name == name; });
  return found == site_.jobs.tours.end() ? nullptr : &*found;
}

std::optional<DriveTarget> JobExecutor::target_of(const JobStop& stop) const {
  if (stop.place.empty()) {
    return DriveTarget{"", stop.pose, stop.has_theta};
  }
  const Place* place = place_called(stop.place);
  return place == nullptr ? std::nullopt : std::optional(DriveTarget{place->name, place->pose, place->has_theta});
}

void JobExecutor::take(const JobRequest& request, std::int64_t utime) {
  if (queue_.is_known(request.id)) {
    return;
  }
  queue_.echo(request.id, act_on(request, utime));
  note_goal();
}

void JobExecutor::withdraw(std::int64_t request, const std::string& objection) {
  queue_.withdraw(request);
  queue_.echo(request, objection);
}

void JobExecutor::set_jobs(JobsFile jobs) {
  site_.jobs = std::move(jobs);
}

std::string JobExecutor::act_on(const JobRequest& request, std::int64_t utime) {
  if (request.action == JobRequest::Action::kAdd) {
    return queue_.is_full() ? fmt::format("{} jobs wait already", JobQueue::kMaxWaiting) : add(request);
  }
  Job* job = queue_.find(request.job);
  if (job == nullptr) {
    return fmt::format("there is no {}", say(request.job));
  }
  if (job->is_over()) {
    return fmt::format("{} is over: {}", say(job->id), job->sentence);
  }
  if (request.action == JobRequest::Action::kConfirm) {
    return confirm(*job, request.word);
  }
  if (request.action == JobRequest::Action::kAnswer) {
    return answer(*job, request.word);
  }
  cancel(*job, utime);
  return "";
}

std::string JobExecutor::objection_to_stops(const std::vector<JobStop>& stops) const {
  for (const JobStop& stop : stops) {
    if (!is_sound(stop)) {
      return "a stop lies impossibly far away, has a pause above an hour or a text above 200 bytes";
    }
    if (!target_of(stop)) {
      std::vector<std::string> names;
      for (const Place& place : site_.places) {
        names.push_back(place.name);
      }
      return fmt::format("no place \"{}\" in {}; known: {}", stop.place, site_.building, fmt::join(names, ", "));
    }
  }
  return "";
}

std::string JobExecutor::objection_to(const JobRequest& request) const {
  if (request.priority < 0 || request.priority > 100) {
    return fmt::format("a priority of {}, must be 0 to 100", request.priority);
  }
  const auto [min, max] = stops_wanted(request);
  if (request.stops.size() < min || request.stops.size() > max) {
    return fmt::format("a job of the kind {} has {} stops, not {}", name_of(request.kind),
                       min == max ? fmt::format("{}", min) : fmt::format("{} to {}", min, max), request.stops.size());
  }
  if (request.kind == JobKind::kHome && place_called(site_.jobs.home) == nullptr) {
    return fmt::format("{} has no home: its jobs file names none", site_.building);
  }
  if (request.kind == JobKind::kTour && !request.tour.empty() && tour_called(request.tour) == nullptr) {
    std::vector<std::string> names;
    for (const Tour& tour : site_.jobs.tours) {
      names.push_back(tour.name);
    }
    return fmt::format("no tour \"{}\" in {}; known: {}", request.tour, site_.building, fmt::join(names, ", "));
  }
  return objection_to_stops(request.stops);
}

std::vector<JobStop> JobExecutor::stops_of(const JobRequest& request) const {
  std::vector<JobStop> stops = request.stops;
  if (request.kind == JobKind::kCarry) {
    stops[0].confirm = "loaded";
    stops[1].confirm = "unloaded";
  } else if (request.kind == JobKind::kTour && !request.tour.empty()) {
    for (const TourStop& stop : tour_called(request.tour)->stops) {
      stops.push_back({.place = stop.place, .pause = stop.pause, .text = stop.text, .photo = stop.photo});
    }
  } else if (request.kind == JobKind::kHome) {
    const Place& home = *place_called(site_.jobs.home);
    if (site_.jobs.has_charger && home.has_theta) {  // straight in, and once more when the contacts were missed
      stops.push_back({"", home.pose * Pose2{-kBeforeHome, 0.0, 0.0}, true});
    }
    stops.push_back({.place = home.name, .pose = home.pose, .has_theta = home.has_theta});
  }
  return stops;
}

std::string JobExecutor::add(const JobRequest& request) {
  std::string objection = objection_to(request);
  if (objection.empty()) {
    Job job;
    job.id = request.id;
    job.kind = request.kind;
    job.priority = request.priority;
    job.on_timeout = request.on_timeout;
    job.tour = request.tour;
    job.sender = request.sender.substr(0, 60);
    job.stops = stops_of(request);
    job.sentence = "waits for its turn";
    queue_.add(std::move(job));
  }
  return objection;
}

std::string JobExecutor::confirm(Job& job, const std::string& word) {
  if (job.kind == JobKind::kGuide && job.state == JobState::kDriving && (word == "here" || word == "wait")) {
    guide_.hear(word);
    return "";
  }
  if (job.state == JobState::kAsking) {
    return answer(job, word);
  }
  const std::string& wanted = job.stops[job.stop].confirm;
  if (job.state == JobState::kAtStop && !wanted.empty()) {
    if (word != wanted && !word.empty()) {
      return fmt::format("{} waits for \"{}\", not for \"{}\"", say(job.id), wanted, word);
    }
    go_on(job);
    return "";
  }
  std::string objection = fmt::format("{} waits for nothing now", say(job.id));
  if (const Job* other = queue_.active(); other != nullptr && other != &job && other->state == JobState::kAtStop &&
                                          !other->stops[other->stop].confirm.empty()) {
    objection += fmt::format("; {} waits for \"{}\"", say(other->id), other->stops[other->stop].confirm);
  }
  return objection;
}

std::string JobExecutor::answer(Job& job, const std::string& word) {
  if (!job.question) {
    return fmt::format("{} asks nothing now", say(job.id));
  }
  const std::vector<std::string> answers = job.question->answers;
  if (std::find(answers.begin(), answers.end(), word) == answers.end()) {
    return fmt::format("\"{}\" is no answer; say one of: {}", word, fmt::join(answers, ", "));
  }
  const std::string question = job.question->text;
  const std::int64_t id = job.id;
  job.question.reset();
  job.goal_id = 0;
  waited_ = 0.0;
  if (word == "give up") {
    queue_.finish(job, JobState::kFailed, fmt::format("given up: {}", question));
  } else if (word == "leave out" || word == "loaded" || word == "unloaded" || word == "charging") {
    go_on(job);
  } else if (word == "wait") {
    job.state = JobState::kAtStop;
  } else {  // opened, go round, try again, go on
    job.state = JobState::kDriving;
    job.stop = job.kind == JobKind::kHome ? 0 : job.stop;  // straight in, from where that begins
  }
  // one that was put back, or is left over, waits for its turn
  if (Job* left = queue_.find(id); left != nullptr && !left->is_over() && queue_.active() != left) {
    left->state = JobState::kQueued;
    left->sentence = "waits for its turn";
  }
  return "";
}

void JobExecutor::cancel(Job& job, std::int64_t utime) {
  if (queue_.active() == &job && drive_.is_open()) {
    drive_.cancel(utime);
  }
  queue_.finish(job, JobState::kCancelled, "cancelled");
}

void JobExecutor::tell_time(const LocalTime& now, std::int64_t utime) {
  for (const Tour* tour : due_tours(site_.jobs.tours, now, table().toured)) {
    const bool is_there = std::any_of(table().jobs.begin(), table().jobs.end(),
                                      [&](const Job& job) { return !job.is_over() && job.tour == tour->name; });
    queue_.start_tour(tour->name, now.day);
    if (is_there || queue_.is_full()) {
      continue;  // yesterday's still waits
    }
    JobRequest request;
    request.id = queue_.free_id(utime);
    request.kind = JobKind::kTour;
    request.tour = tour->name;
    request.sender = "schedule";
    add(request);
  }
}

}  // namespace luminav
