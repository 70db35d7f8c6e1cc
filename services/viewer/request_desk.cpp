#include "services/viewer/request_desk.hpp"

#include <algorithm>
#include <luminav/supervision_t.hpp>
#include <utility>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {

std::int64_t RequestDesk::new_id(std::int64_t now) {
  last_id_ = std::max(now, last_id_ + 1);
  return last_id_;
}

template <typename Message>
std::int64_t RequestDesk::post(Kind kind, const char* channel, Message message, std::int64_t now, bool gives_up) {
  const std::lock_guard lock(mutex_);
  message.id = new_id(now);
  Pending& pending = pending_[static_cast<std::size_t>(kind)];
  pending.state = {kind, Fate::kWaiting, message.id, now, "", kind == Kind::kStop && !gives_up};
  pending.gives_up = gives_up;
  pending.publish = [this, channel, message](std::int64_t utime) mutable {
    message.utime = utime;
    return commands_.publish(channel, message) >= 0;
  };
  if (kind == Kind::kStop) {
    for (StopEcho* owner : {&driver_, &controller_}) {
      owner->obeyed = false;
      owner->id_when_asked = owner->id;
    }
  }
  if (!pending.publish(now)) {
    if (gives_up) {
      pending.state.fate = Fate::kUnanswered;
    }
    throw NotSent(gives_up ? "the network took nothing: it was not sent"
                           : "the network took nothing: it was not sent, but is tried again");
  }
  return message.id;
}

void RequestDesk::object(std::string why) {
  const std::lock_guard lock(mutex_);
  objection_ = std::move(why);
}

void RequestDesk::check_objection() const {
  const std::lock_guard lock(mutex_);
  if (!objection_.empty()) {
    throw RequestError("this page shows " + objection_);
  }
}

std::int64_t RequestDesk::send(goal_t goal, std::int64_t now) {
  if (goal.action == goal_t::ACTION_GO) {
    check_objection();
  }
  return post(Kind::kGoal, channels::kGoal, std::move(goal), now);
}

std::int64_t RequestDesk::send(stop_t stop, std::int64_t now) {
  const bool gives_up = stop.engaged == 0;
  stop.sender = sender_;
  return post(Kind::kStop, channels::kStop, std::move(stop), now, gives_up);
}

std::int64_t RequestDesk::send(motors_command_t command, std::int64_t now) {
  return post(Kind::kMotors, channels::kMotorsCommand, command, now);
}

std::int64_t RequestDesk::send(initial_pose_t guess, std::int64_t now) {
  check_objection();
  return post(Kind::kInitialPose, channels::kInitialPose, std::move(guess), now);
}

std::int64_t RequestDesk::send(map_command_t command, std::int64_t now) {
  return post(Kind::kMap, channels::kMapCommand, std::move(command), now);
}

std::int64_t RequestDesk::send(survey_command_t command, std::int64_t now) {
  return post(Kind::kSurvey, channels::kSurveyCommand, std::move(command), now);
}

std::int64_t RequestDesk::send(job_t job, std::int64_t now) {
  constexpr std::size_t kMaxPending = 100;
  if (job.action == job_t::ACTION_ADD) {
    check_objection();
  }
  const std::lock_guard lock(mutex_);
  if (pending_jobs_.size() >= kMaxPending) {
    throw NotSent("the job service has not taken up the last hundred requests");
  }
  job.id = new_id(now);
  job.utime = now;
  job.sender = sender_;
  if (commands_.publish(channels::kJob, job) < 0) {
    throw NotSent("the network took nothing: it was not sent");
  }
  pending_jobs_.push_back(std::move(job));
  return pending_jobs_.back().id;
}

void RequestDesk::on_job_status(const job_status_t& message) {
  const std::lock_guard lock(mutex_);
  const auto& ids = message.echo_ids;
  std::erase_if(pending_jobs_,
                [&](const job_t& job) { return std::find(ids.begin(), ids.end(), job.id) != ids.end(); });
  // far below what it knows it acts on nothing: somebody's clock is ahead of ours, or the robot's is
  for (const std::int64_t id : ids) {
    last_id_ = std::max(last_id_, id);
  }
  for (const job_state_t& job : message.jobs) {
    last_id_ = std::max(last_id_, job.id);
  }
}

void RequestDesk::attend(std::int64_t now) {
  constexpr std::int64_t kPeriod = 200'000;  // [us]
  const std::lock_guard lock(mutex_);
  if (now - attended_ < kPeriod && now >= attended_) {
    return;
  }
  supervision_t supervision{};
  supervision.utime = now;
  supervision.sender = sender_;
  if (commands_.publish(channels::kSupervision, supervision) < 0) {
    throw NotSent("the network takes nothing");
  }
  attended_ = now;
}

void RequestDesk::repeat(std::int64_t now) {
  const std::lock_guard lock(mutex_);
  for (Pending& pending : pending_) {
    if (pending.state.fate != Fate::kWaiting) {
      continue;
    }
    if (pending.gives_up && now - pending.state.asked > kPatience) {
      pending.state.fate = Fate::kUnanswered;
      continue;
    }
    pending.publish(now);
  }
  std::erase_if(pending_jobs_, [&](const job_t& job) { return now - job.utime > kPatience; });
  for (const job_t& job : pending_jobs_) {
    commands_.publish(channels::kJob, job);
  }
}

// Called with the lock held.
void RequestDesk::hear(Kind kind, std::int64_t id, const std::string& objection) {
  // ids of hosts whose clock is ahead: ours must still be newer. A year ahead is damage, not a clock.
  constexpr std::int64_t kYear = 366LL * 86'400 * 1'000'000;  // [us]
  if (id > last_id_ && is_stamp(id) && (last_id_ == 0 || id - last_id_ < kYear)) {
    last_id_ = id;
  }
  State& state = pending_[static_cast<std::size_t>(kind)].state;
  if (kind != Kind::kStop && state.fate == Fate::kWaiting && state.id == id) {
    state.fate = Fate::kAnswered;
    state.objection = objection;
  }
}

void RequestDesk::on_navigation_status(const navigation_status_t& message) {
  const std::lock_guard lock(mutex_);
  hear(Kind::kGoal, message.goal_id);
}

// A STOP has two owners, driver and controller. Both must have obeyed: an id alone may be another's.
void RequestDesk::hear_of_stop(StopEcho& owner, std::int64_t id, bool engaged) {
  hear(Kind::kStop, id);
  State& state = pending_[static_cast<std::size_t>(Kind::kStop)].state;
  const bool is_another_stop =
      owner.heard && engaged && id != state.id && id != driver_.id_when_asked && id != controller_.id_when_asked;
  owner.id = id;
  owner.engaged = engaged;
  owner.heard = true;
  if (state.fate != Fate::kWaiting) {
    return;
  }
  owner.obeyed = owner.obeyed || (id == state.id && engaged == state.engages);
  if (driver_.obeyed && controller_.obeyed) {
    state.fate = Fate::kAnswered;
  } else if (is_another_stop && !state.engages) {
    state.fate = Fate::kUnanswered;
    state.objection = "somebody asked for another stop meanwhile";
  }
}

void RequestDesk::on_control_status(const control_status_t& message) {
  const std::lock_guard lock(mutex_);
  hear_of_stop(controller_, message.stop_id, message.stop_engaged != 0);
}

void RequestDesk::on_robot_status(const robot_status_t& message) {
  const std::lock_guard lock(mutex_);
  hear_of_stop(driver_, message.stop_id, message.stop_engaged != 0);
  hear(Kind::kMotors, message.motors_command_id);
}

void RequestDesk::on_pose(const pose_t& message) {
  const std::lock_guard lock(mutex_);
  hear(Kind::kInitialPose, message.initial_pose_id);
}

void RequestDesk::on_grid_tile(const grid_tile_t& message) {
  const std::lock_guard lock(mutex_);
  hear(Kind::kMap, message.map_command_id, message.map_command_result);
}

void RequestDesk::on_survey_status(const survey_status_t& message) {
  const std::lock_guard lock(mutex_);
  hear(Kind::kSurvey, message.echo_id, message.objection);
}

std::vector<RequestDesk::State> RequestDesk::states() const {
  const std::lock_guard lock(mutex_);
  std::vector<State> states;
  for (const Pending& pending : pending_) {
    if (pending.state.fate != Fate::kNone) {
      states.push_back(pending.state);
    }
  }
  return states;
}

std::string_view RequestDesk::name_of(Kind kind) {
  switch (kind) {
    case Kind::kGoal:
      return "goal";
    case Kind::kStop:
      return "stop";
    case Kind::kMotors:
      return "motors";
    case Kind::kInitialPose:
      return "initial_pose";
    case Kind::kMap:
      return "map";
    case Kind::kSurvey:
      return "survey";
  }
  return "";
}

std::string_view RequestDesk::name_of(Fate fate) {
  switch (fate) {
    case Fate::kNone:
      return "none";
    case Fate::kWaiting:
      return "waiting";
    case Fate::kAnswered:
      return "answered";
    case Fate::kUnanswered:
      return "unanswered";
  }
  return "";
}

}  // namespace luminav
