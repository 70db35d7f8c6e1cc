#include "services/jobs/job_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr double kStill = 0.02;        // [m/s, rad/s]
constexpr std::size_t kMaxSaid = 250;  // [bytes] of a sentence: all jobs fit into one datagram

bool is_within(int value, int last) {
  return value >= 0 && value <= last;
}

/// Cut between two characters of UTF-8.
std::string cut(const std::string& text) {
  std::size_t length = std::min(text.size(), kMaxSaid);
  while (length < text.size() && length > 0 && (static_cast<unsigned char>(text[length]) & 0xc0U) == 0x80U) {
    --length;
  }
  return text.substr(0, length);
}

Drive drive_from(std::int8_t state) {
  using Status = navigation_status_t;
  switch (state) {
    case Status::STATE_IDLE:
      return Drive::kNone;
    case Status::STATE_ARRIVED:
      return Drive::kArrived;
    case Status::STATE_NO_PATH:
      return Drive::kNoPath;
    case Status::STATE_BLOCKED:
      return Drive::kBlocked;
    case Status::STATE_STUCK:
      return Drive::kStuck;
    case Status::STATE_CANCELLED:
      return Drive::kCancelled;
    case Status::STATE_LOST:
      return Drive::kLost;
    case Status::STATE_PAUSED:
      return Drive::kPaused;
    default:
      return Drive::kUnderWay;
  }
}

job_state_t state_from(const Job& job, int position) {
  job_state_t message{};
  message.id = job.id;
  message.kind = static_cast<std::int8_t>(job.kind);
  message.state = static_cast<std::int8_t>(job.state);
  message.priority = job.priority;
  message.position = position;
  message.sender = cut(job.sender);
  message.sentence = cut(job.sentence);
  message.stop = static_cast<std::int32_t>(job.stop);
  for (const JobStop& stop : job.stops) {
    message.stops.push_back(cut(name_of(stop)).substr(0, 30));
  }
  message.stop_count = static_cast<std::int32_t>(message.stops.size());
  if (job.state == JobState::kAtStop) {
    message.waits_for = job.stops[job.stop].confirm;
    message.text = job.stops[job.stop].text;
  }
  if (job.question) {
    message.question = cut(job.question->text);
    message.answers = job.question->answers;
    message.answer_count = static_cast<std::int32_t>(message.answers.size());
  }
  return message;
}

}  // namespace

std::optional<JobRequest> request_from(const job_t& message) {
  if (!is_within(message.action, job_t::ACTION_ANSWER) || !is_within(message.kind, job_t::KIND_GUIDE) ||
      !is_within(message.on_timeout, job_t::TIMEOUT_GO_ON) ||
      static_cast<std::size_t>(message.count) != message.stops.size()) {
    return std::nullopt;
  }
  JobRequest request;
  request.id = message.id;
  request.action = static_cast<JobRequest::Action>(message.action);
  request.job = message.job;
  request.kind = static_cast<JobKind>(message.kind);
  request.priority = message.priority;
  request.on_timeout = static_cast<TimeoutPolicy>(message.on_timeout);
  request.tour = message.tour;
  for (const job_stop_t& stop : message.stops) {
    request.stops.push_back(
        {stop.place, {stop.x, stop.y, wrap_angle(stop.theta)}, stop.has_theta != 0, stop.pause, stop.text});
  }
  request.word = message.word;
  request.sender = message.sender;
  return request;
}

Navigation navigation_from(const navigation_status_t& message) {
  Navigation navigation{message.goal_id, drive_from(message.state), message.cause, std::nullopt, message.distance_left};
  if (message.has_target != 0) {
    navigation.target = DriveTarget{"", {message.x, message.y, message.theta}, message.has_theta != 0};
  }
  return navigation;
}

std::string who_handles(const robot_status_t& status) {
  const bool moves = std::abs(status.linear) > kStill || std::abs(status.angular) > kStill;
  return status.connected == 0                                   ? "the robot does not answer"
         : status.stop_engaged != 0                              ? "a stop is engaged"
         : status.stop_button != 0                               ? "the button on the robot is pressed"
         : status.bumpers_front != 0 || status.bumpers_rear != 0 ? "a bumper is pressed"
         : status.motors_enabled == 0                            ? "the motors are off"
         : moves && status.command_fresh == 0                    ? "somebody moves it"
                                                                 : "";
}

goal_t goal_from(const DriveRequest& request, std::int64_t utime) {
  goal_t goal{};
  goal.utime = utime;
  goal.id = request.id;
  goal.action = static_cast<std::int8_t>(request.action);
  if (request.action == DriveAction::kGo) {
    const DriveTarget& target = request.target;
    goal.policy = goal_t::POLICY_STOP;
    goal.count = 1;
    goal.poses.push_back({target.place, target.pose.x, target.pose.y, static_cast<std::int8_t>(target.has_theta),
                          target.pose.theta, 0.0});
  }
  return goal;
}

job_status_t status_from(const JobExecutor& executor) {
  job_status_t status{};
  const std::int64_t active = executor.table().active;
  int position = active == 0 ? 1 : 0;
  for (const Job* job : executor.queue().in_order()) {
    status.jobs.push_back(state_from(*job, job->is_over() ? -1 : position++));
  }
  status.count = static_cast<std::int32_t>(status.jobs.size());
  for (const RequestEcho& echo : executor.table().echoes) {
    status.echo_ids.push_back(echo.id);
    status.objections.push_back(cut(echo.objection));
  }
  status.echo_count = static_cast<std::int32_t>(status.echo_ids.size());
  for (const Tour& tour : executor.site().jobs.tours) {
    status.tours.push_back(cut(tour.name));
  }
  status.tour_count = static_cast<std::int32_t>(status.tours.size());
  return status;
}

}  // namespace luminav
