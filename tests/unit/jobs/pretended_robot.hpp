#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "services/jobs/job_executor.hpp"

namespace luminav {

/// A job service, and a robot and a planner that do as they are told: in each step of a fifth of a second the planner
/// takes up what is asked, and arrives when `arrive` says so.
class PretendedRobot {
 public:
  static JobSite site() {
    return {
        .building = "laboratory",
        .places = {{"lab", {1.0, 2.0, 0.0}, false}, {"office", {8.0, 2.0, 1.0}, true}, {"dock", {5.0, 0.0, 0.0}, true}},
        .jobs = {
            .home = "dock",
            .has_charger = true,
            .tours = {
                {.name = "morning", .stops = {{.place = "lab", .pause = 5.0}, {.place = "office"}}, .at = 34200}}}};
  }

  explicit PretendedRobot(const JobParams& params = {}) : executor(params, site()) {}
  PretendedRobot(const JobParams& params, JobSite site) : executor(params, std::move(site)) {}

  /// Sends a request; returns what the service objects to.
  std::string ask(JobRequest request) {
    if (request.id == 0) {
      request.id = new_id();
    }
    last_id = std::max(last_id, request.id);
    executor.take(request, moment.utime);
    for (const RequestEcho& echo : executor.table().echoes) {
      if (echo.id == request.id) {
        return echo.objection;
      }
    }
    return "not echoed";
  }
  std::int64_t add(JobKind kind, const std::vector<std::string>& places, int priority = 0) {
    JobRequest request;
    request.id = new_id();
    request.kind = kind;
    request.priority = priority;
    for (const std::string& place : places) {
      request.stops.push_back({.place = place});
    }
    const std::string objection = ask(request);
    return objection.empty() ? request.id : 0;
  }
  std::string say(JobRequest::Action action, std::int64_t job, const std::string& word = "") {
    JobRequest request;
    request.action = action;
    request.job = job;
    request.word = word;
    return ask(request);
  }

  void step() {
    moment.utime += 200'000;
    moment.seconds = 0.2;
    if (const auto goal = executor.goal(); goal && goal->id > navigation.goal_id && !is_deaf) {
      navigation.goal_id = goal->id;
      if (goal->action == DriveAction::kGo) {
        goals.push_back(goal->target.place);
        navigation.target = goal->target;
        navigation.state = Drive::kUnderWay;
      } else if (goal->action == DriveAction::kCancel) {
        navigation.state = Drive::kCancelled;
      } else if (navigation.state == Drive::kUnderWay) {
        navigation.state = Drive::kPaused;
      }
    }
    moment.navigation = navigation;
    executor.update(moment);
  }
  void run(double seconds) {
    for (double t = 0.0; t < seconds - 1e-9; t += 0.2) {
      step();
    }
  }
  /// The planner ends its goal so.
  void end_drive(Drive state, const std::string& cause = "") {
    run(3.0);
    navigation.state = state;
    navigation.cause = cause;
    step();
    navigation.cause.clear();
  }
  void arrive() { end_drive(Drive::kArrived); }

  [[nodiscard]] const Job& job(std::int64_t id) const {
    for (const Job& known : executor.table().jobs) {
      if (known.id == id) {
        return known;
      }
    }
    static const Job kNone{};
    return kNone;
  }

  JobExecutor executor;
  JobMoment moment{.utime = 1'000'000'000, .voltage = 13.0};
  Navigation navigation;
  std::vector<std::string> goals;  // places that the planner was sent to; "" = a point
  bool is_deaf = false;            // the planner
  std::int64_t last_id = 100;

 private:
  /// From the clock, as people's are.
  std::int64_t new_id() {
    last_id = std::max(last_id + 1, moment.utime);
    return last_id;
  }
};

}  // namespace luminav
