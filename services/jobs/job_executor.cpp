#include "services/jobs/job_executor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr double kPhotoPatience = 3.0;    // [s] for a picture of the camera, which takes 15 a second
constexpr double kPlannerPatience = 5.0;  // [s] it speaks once a second at least

}  // namespace

JobExecutor::JobExecutor(const JobParams& params, JobSite site)
    : params_(params), site_(std::move(site)), battery_(params.battery), guide_(params.guide, site_.walls) {}

void JobExecutor::load(JobTable table) {
  queue_.restore(std::move(table));
  for (const Job& job : queue_.table().jobs) {
    left_over_.push_back(job.id);
  }
  Job* job = queue_.active();
  if (job != nullptr && job->kind == JobKind::kGuide && job->state == JobState::kDriving) {
    job->goal_id = 0;  // where its visitor was is not kept: it stops, and begins anew with whoever stands there
  }
  const bool drives = job != nullptr && job->state == JobState::kDriving && job->goal_id != 0;
  const std::optional<DriveTarget> target = drives ? target_of(job->stops[job->stop]) : std::nullopt;
  const std::int64_t open_goal = queue_.table().open_goal;
  if (target) {
    drive_.take_over(*target, job->goal_id);
  } else if (open_goal != 0) {  // of a job that was cancelled
    drive_.take_over({}, open_goal);
    drive_.cancel(open_goal + 1);
  }
}

void JobExecutor::ask_for_left_over(const std::string& why) {
  for (const std::int64_t id : left_over_) {
    if (Job* job = queue_.find(id); job != nullptr && !job->is_over()) {
      job->goal_id = 0;
      ask(*job, fmt::format("it was left over, {}: is it still to be done?", why), {"go on", "give up"});
    }
  }
  queue_.deactivate();
  drive_.forget();
  note_goal();
}

std::optional<double> JobExecutor::speed_limit() const {
  const Job* job = active();
  const bool guides = job != nullptr && job->kind == JobKind::kGuide && job->state == JobState::kDriving;
  return guides && drive_.is_open() ? std::optional(guide_.max_speed()) : std::nullopt;
}

std::optional<PhotoWish> JobExecutor::wanted_photo() const {
  const Job* job = active();
  const bool wants = job != nullptr && job->state == JobState::kAtStop && job->stops[job->stop].photo && !has_photo_;
  return wants ? std::optional(PhotoWish{job->id, job->stop, name_of(job->stops[job->stop])}) : std::nullopt;
}

std::optional<DriveRequest> JobExecutor::end() {
  if (!drive_.is_open()) {
    return std::nullopt;
  }
  drive_.cancel(drive_.goal_id() + 1);
  return drive_.request();
}

void JobExecutor::note_goal() {
  queue_.open_goal(drive_.is_open() ? drive_.goal_id() : 0);
  if (Job* job = queue_.active(); job != nullptr && job->goal_id != 0 && job->state == JobState::kDriving) {
    job->goal_id = drive_.goal_id();
  }
}

void JobExecutor::update(const JobMoment& moment) {
  waited_ += moment.seconds;
  planner_silent_ = moment.navigation ? 0.0 : planner_silent_ + moment.seconds;
  untouched_ = moment.handled.empty() ? untouched_ + moment.seconds : 0.0;
  if (moment.navigation) {
    drive_.hear(*moment.navigation);
  }
  look_after_battery(moment);
  start_next();
  if (Job* job = queue_.active()) {
    switch (job->state) {
      case JobState::kDriving:
        drive(*job, moment);
        break;
      case JobState::kAtStop:
        stay(*job, moment);
        break;
      case JobState::kAsking:
        wait_for_answer(*job);
        break;
      default:
        queue_.deactivate();
    }
  }
  note_goal();
}

// ---------------------------------------------------------------------------------------------------- which job

void JobExecutor::look_after_battery(const JobMoment& moment) {
  const Place* home = place_called(site_.jobs.home);
  if (home == nullptr) {
    return;
  }
  const double distance =
      moment.world_from_robot ? (moment.world_from_robot->position() - home->pose.position()).norm() : 0.0;
  battery_.update(moment.voltage, distance, moment.seconds, moment.charger);
  if (!battery_.is_low()) {
    sent_for_battery_ = false;
  } else if (!sent_for_battery_) {
    sent_for_battery_ = true;
    send_home(kUrgent, fmt::format("the battery is at {:.1f} V", battery_.voltage()), moment.utime);
  }
  const bool is_idle = queue_.active() == nullptr && queue_.next() == nullptr;
  idle_ = is_idle ? idle_ + moment.seconds : 0.0;
  if (params_.idle_time > 0.0 && idle_ > params_.idle_time && !sent_for_idleness_) {
    sent_for_idleness_ = true;
    send_home(0, "nothing to do", moment.utime);
  }
  Job* active = queue_.active();
  const Job* next = queue_.next();
  if (active != nullptr && active->kind != JobKind::kHome && next != nullptr && next->priority >= kUrgent) {
    put_back(*active, moment.utime);
  }
}

void JobExecutor::send_home(int priority, const std::string& why, std::int64_t utime) {
  for (const Job* job : queue_.in_order()) {
    if (job->kind == JobKind::kHome && !job->is_over()) {
      Job& waiting = *queue_.find(job->id);
      waiting.priority = std::max(waiting.priority, priority);
      return;
    }
  }
  JobRequest request;
  request.id = queue_.free_id(utime);
  request.kind = JobKind::kHome;
  request.sender = why;
  if (add(request).empty()) {
    queue_.find(request.id)->priority = priority;
  }
}

void JobExecutor::put_back(Job& job, std::int64_t utime) {
  if (drive_.is_open()) {
    drive_.cancel(utime);
  }
  job.goal_id = 0;
  if (job.state != JobState::kAsking) {
    job.state = JobState::kQueued;
    job.sentence = "goes on after the battery is charged";
  }
  queue_.deactivate();
}

void JobExecutor::start_next() {
  Job* next = queue_.active() == nullptr ? queue_.next() : nullptr;
  if (next == nullptr) {
    return;
  }
  if (battery_.is_low() && next->kind != JobKind::kHome) {
    next->sentence = fmt::format("the battery is charged first: {:.1f} V", battery_.voltage());
    return;
  }
  sent_for_idleness_ = next->kind == JobKind::kHome;
  queue_.activate(*next);
  next->state = JobState::kDriving;
  next->goal_id = 0;
  waited_ = 0.0;
}

// ---------------------------------------------------------------------------------------------------- driving

void JobExecutor::depart(Job& job, const JobMoment& moment) {
  const std::optional<DriveTarget> target = target_of(job.stops[job.stop]);
  if (!target) {
    queue_.finish(job, JobState::kFailed,
                  fmt::format("{} has no place \"{}\" any more", site_.building, job.stops[job.stop].place));
    return;
  }
  if (untouched_ < params_.untouched) {
    job.sentence = moment.handled.empty() ? "drives off in a moment" : fmt::format("stands: {}", moment.handled);
    return;
  }
  drive_.begin(*target, moment.utime);
  job.goal_id = drive_.goal_id();
  guide_.begin();
}

void JobExecutor::drive(Job& job, const JobMoment& moment) {
  if (job.goal_id == 0) {
    depart(job, moment);
    return;
  }
  if (job.kind == JobKind::kGuide && guide(job, moment)) {
    return;
  }
  const std::string place = name_of(job.stops[job.stop]);
  switch (drive_.state()) {
    case Drive::kUnderWay:
      job.sentence = fmt::format("drives to {}", place);
      if (planner_silent_ > kPlannerPatience) {
        job.sentence += fmt::format("; the planner has been silent for {:.0f} s", planner_silent_);
      } else if (drive_.distance_left() > 0.0) {
        job.sentence += fmt::format(", {:.0f} m left", drive_.distance_left());
      }
      if (!drive_.cause().empty()) {
        job.sentence += fmt::format(": {}", drive_.cause());
      }
      break;
    case Drive::kPaused:
      job.sentence = fmt::format("paused on the way to {}: {}", place, drive_.cause());
      break;
    case Drive::kArrived:
      job.state = JobState::kAtStop;
      job.sentence = fmt::format("is at {}", place);
      has_photo_ = false;
      waited_ = 0.0;
      break;
    case Drive::kNone:
    case Drive::kForgotten:
      job.goal_id = 0;
      break;
    default:
      ask_about_drive(job);
  }
}

/// True as long as the visitor, not the place, decides what is done.
bool JobExecutor::guide(Job& job, const JobMoment& moment) {
  const bool drives = drive_.is_open();
  const bool is_shut = drive_.state() == Drive::kBlocked || drive_.state() == Drive::kStuck;
  if (!drives && drive_.state() != Drive::kArrived && (guide_.leads() || !is_shut)) {
    return false;
  }
  switch (guide_.update({moment.seconds, moment.driven, moment.echoes, moment.world_from_robot, !drives})) {
    case GuideWatch::Advice::kWait:
      drive_.pause(moment.utime);
      break;
    case GuideWatch::Advice::kLeadOn:
      if (const auto target = target_of(job.stops[job.stop])) {
        drive_.begin(*target, moment.utime);
      }
      return true;
    case GuideWatch::Advice::kGoBack:
      drive_.begin({"", *guide_.last_seen(), false}, moment.utime);
      break;
    case GuideWatch::Advice::kGiveUp:
      drive_.cancel(moment.utime);
      queue_.finish(job, JobState::kFailed,
                    fmt::format("its visitor does not follow any more; {} is {:.0f} m from here",
                                name_of(job.stops[job.stop]), drive_.distance_left()));
      return true;
    case GuideWatch::Advice::kNone:
      break;
  }
  if (guide_.leads()) {
    return false;
  }
  job.sentence = guide_.sentence();
  return true;
}

void JobExecutor::ask_about_drive(Job& job) {
  std::vector<std::string> answers;
  std::string what = drive_.cause();
  switch (drive_.state()) {
    case Drive::kBlocked:
      answers = {"opened"};
      break;
    case Drive::kStuck:
      answers = {"go round"};
      break;
    case Drive::kCancelled:
      answers = {"go on"};
      what = "somebody cancelled the drive";
      break;
    case Drive::kReplaced:
      answers = {"go on"};
      what = "somebody sent the robot elsewhere";
      break;
    default:
      answers = {"try again"};
  }
  if (job.kind == JobKind::kTour && job.stop + 1 < job.stops.size()) {
    answers.emplace_back("leave out");
  }
  answers.emplace_back("give up");
  ask(job, fmt::format("on the way to {}: {}", name_of(job.stops[job.stop]), what), std::move(answers));
}

// ---------------------------------------------------------------------------------------------------- standing

void JobExecutor::stay(Job& job, const JobMoment& moment) {
  const JobStop& stop = job.stops[job.stop];
  const bool is_last = job.stop + 1 == job.stops.size();
  if (!stop.confirm.empty()) {
    wait_for_word(job, stop);
  } else if (job.kind == JobKind::kHome && site_.jobs.has_charger && is_last) {
    wait_for_charger(job, moment);
  } else if (waited_ >= stop.pause && !(wanted_photo() && waited_ < kPhotoPatience)) {
    go_on(job);
  }
}

void JobExecutor::wait_for_word(Job& job, const JobStop& stop) {
  job.sentence = fmt::format("is at {} and waits for \"{}\"", name_of(stop), stop.confirm);
  if (waited_ < params_.handover_timeout) {
    return;
  }
  const std::string what = fmt::format("nobody said \"{}\" at {} for {:.0f} min", stop.confirm, name_of(stop),
                                       params_.handover_timeout / 60.0);
  switch (job.on_timeout) {
    case TimeoutPolicy::kAsk:
      ask(job, what, {stop.confirm, "wait", "give up"});
      break;
    case TimeoutPolicy::kGiveUp:
      queue_.finish(job, JobState::kFailed, what);
      break;
    case TimeoutPolicy::kGoOn:
      go_on(job);
      break;
  }
}

void JobExecutor::wait_for_charger(Job& job, const JobMoment& moment) {
  job.sentence = "is at home and looks whether it charges";
  const bool is_heard = moment.charger != Charger::kNotHeard;
  if (is_heard && moment.voltage >= params_.battery.charging) {
    queue_.finish(job, JobState::kDone, fmt::format("charges at {:.1f} V", moment.voltage));
    return;
  }
  if (waited_ < params_.charge_wait) {
    return;
  }
  if (++job.tries < params_.charge_attempts) {
    job.stop = 0;
    job.goal_id = 0;
    job.state = JobState::kDriving;
    return;
  }
  job.tries = 0;
  ask(job,
      fmt::format("it stands at home after {} tries and does not charge: the charger is {}, the battery at {:.1f} V",
                  params_.charge_attempts, is_heard ? "heard" : "not heard", moment.voltage),
      {"charging", "try again", "give up"});
}

void JobExecutor::wait_for_answer(Job& job) {
  if (waited_ >= params_.question_timeout) {
    queue_.finish(
        job, JobState::kFailed,
        fmt::format("nobody answered for {:.0f} min: {}", params_.question_timeout / 60.0, job.question->text));
  }
}

void JobExecutor::go_on(Job& job) {
  const std::string at = name_of(job.stops[job.stop]);
  waited_ = 0.0;
  job.goal_id = 0;
  if (++job.stop < job.stops.size()) {
    job.state = JobState::kDriving;
    job.sentence = fmt::format("goes on to {}", name_of(job.stops[job.stop]));
    return;
  }
  --job.stop;  // where it stands
  queue_.finish(job, JobState::kDone, fmt::format("done, at {}", at));
}

void JobExecutor::ask(Job& job, const std::string& text, std::vector<std::string> answers) {
  job.state = JobState::kAsking;
  job.question = Question{text, std::move(answers)};
  job.sentence = text;
  waited_ = 0.0;
}

}  // namespace luminav
