#include "tests/evaluation/runs/job_people.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kRepeat = 200'000;  // [us] requests go out at 5 Hz until echoed
constexpr std::size_t kPatientQueue = 15;  // jobs that wait; then people order later
constexpr double kAnswerAfter = 60.0;      // [s] until somebody sees a question
constexpr int kAnswers = 3;                // for a job, then somebody has enough

bool is_over(const job_state_t& job) {
  return job.state >= job_state_t::STATE_DONE;
}

bool has(const std::vector<std::string>& words, const char* word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

JobPeople::JobPeople(lcm::LCM& lcm, const Scenario& scenario, DrawnJobs drawn, World& world)
    : lcm_(lcm),
      scenario_(scenario),
      drawn_(std::move(drawn)),
      world_(world),
      random_(scenario.seed, "people of jobs"),
      subscriber_(lcm) {
  subscriber_.on(channels::kSimTruth, &JobPeople::on_truth, this);
  subscriber_.on(channels::kJobStatus, &JobPeople::on_jobs, this);
}

const PlannedJob* JobPeople::ordered(std::int64_t id) const {
  const auto found = ordered_.find(id);
  return found == ordered_.end() ? nullptr : found->second;
}

bool JobPeople::is_finished() const {
  const auto last_tour = std::max_element(drawn_.tours.begin(), drawn_.tours.end(),
                                          [](const Tour& a, const Tour& b) { return *a.at < *b.at; });
  const double all_started = last_tour == drawn_.tours.end() ? 0.0 : *last_tour->at - kMorning + 5.0;
  return ordered_.size() == drawn_.jobs.size() && open_.empty() && elapsed_ > all_started && status_ &&
         std::all_of(status_->jobs.begin(), status_->jobs.end(), is_over);
}

void JobPeople::on_truth(const sim_truth_t& truth) {
  if (first_ == 0) {
    first_ = truth.utime;
  }
  elapsed_ = 1e-6 * static_cast<double>(truth.utime - first_);
  last_id_ = std::max(last_id_, truth.utime);
  if (dock_free_at_ > 0.0 && elapsed_ >= dock_free_at_) {
    dock_free_at_ = 0.0;
    world_.remove_bystanders();
  }
  if (status_) {
    order();
    for (const job_state_t& job : status_->jobs) {
      look_after(job);
    }
  }
  send(truth.utime);
}

void JobPeople::on_jobs(const job_status_t& status) {
  status_ = status;
  std::erase_if(open_, [&](const Request& request) {
    const auto echo = std::find(status.echo_ids.begin(), status.echo_ids.end(), request.message.id);
    if (echo == status.echo_ids.end()) {
      return false;
    }
    const std::string& objection = status.objections[static_cast<std::size_t>(echo - status.echo_ids.begin())];
    if (!objection.empty()) {
      objections_.push_back(objection);
    } else if (request.message.action == job_t::ACTION_ADD) {
      promised_.push_back(request.message.id);
    }
    return true;
  });
}

void JobPeople::order() {
  const auto waiting =
      std::count_if(status_->jobs.begin(), status_->jobs.end(), [](const job_state_t& job) { return !is_over(job); });
  const std::size_t next = ordered_.size();
  if (next == drawn_.jobs.size() || drawn_.jobs[next].at > elapsed_ || !open_.empty() ||
      static_cast<std::size_t>(waiting) >= kPatientQueue) {
    return;
  }
  Request request{drawn_.jobs[next].request};
  request.message.id = ++last_id_;
  request.message.action = job_t::ACTION_ADD;
  request.message.sender = "evaluation";
  ordered_[request.message.id] = &drawn_.jobs[next];
  open_.push_back(request);
}

void JobPeople::send(std::int64_t utime) {
  for (Request& request : open_) {
    if (utime - request.sent >= kRepeat) {
      request.sent = request.message.utime = utime;
      lcm_.publish(channels::kJob, &request.message);
    }
  }
}

void JobPeople::ask(const job_state_t& job, std::int8_t action, const std::string& word) {
  Request request;
  request.message.id = ++last_id_;
  request.message.action = action;
  request.message.job = job.id;
  request.message.word = word;
  request.message.sender = "evaluation";
  open_.push_back(request);
}

void JobPeople::look_after(const job_state_t& job) {
  Notice& notice = notices_[job.id];
  if (const std::pair<int, int> state{job.state, job.stop}; state != notice.state) {
    notice.state = state;
    notice.since = elapsed_;
    notice.is_dealt_with = false;
  }
  if (notice.is_dealt_with) {
    return;
  }
  if (is_over(job)) {
    notice.is_dealt_with = true;
    if (job.kind == job_t::KIND_GUIDE) {
      world_.remove_visitors();
    }
  } else if (job.state == job_state_t::STATE_AT_STOP && !job.waits_for.empty()) {
    hand_over(job, notice);
  } else if (job.state == job_state_t::STATE_ASKING) {
    answer(job, notice);
  } else if (job.state == job_state_t::STATE_DRIVING && !notice.is_visited) {
    job.kind == job_t::KIND_GUIDE  ? come_along(job, notice)
    : job.kind == job_t::KIND_HOME ? stand_in_dock(notice)
                                   : void();
  }
}

void JobPeople::hand_over(const job_state_t& job, Notice& notice) {
  const PlannedJob* plan = ordered(job.id);
  const double wait = plan == nullptr ? 0.0 : plan->handover.at(static_cast<std::size_t>(job.stop));
  if (elapsed_ - notice.since >= wait) {
    notice.is_dealt_with = true;
    ask(job, job_t::ACTION_CONFIRM, job.waits_for);
  }
}

void JobPeople::answer(const job_state_t& job, Notice& notice) {
  if (elapsed_ - notice.since < kAnswerAfter || job.answers.empty()) {
    return;
  }
  notice.is_dealt_with = true;
  ++answers_;
  // nobody came to load, or it was in vain; else what was in its way is gone
  const bool gives_up = has(job.answers, "wait") || ++notice.answers > kAnswers;
  ask(job, job_t::ACTION_ANSWER,
      gives_up                        ? "give up"
      : has(job.answers, "try again") ? "try again"
                                      : job.answers.front());
}

void JobPeople::come_along(const job_state_t& job, Notice& notice) {
  const PlannedJob* plan = ordered(job.id);
  notice.is_visited = plan == nullptr || world_.add_visitor(plan->visitor);
}

void JobPeople::stand_in_dock(Notice& notice) {
  notice.is_visited = true;
  const bool comes = random_.happens(0.5);
  const double stays = random_.uniform(60.0, 200.0);  // [s]
  if (comes && scenario_.dock && dock_free_at_ == 0.0 && world_.add_bystander(scenario_.dock->pose.position())) {
    dock_free_at_ = elapsed_ + stays;
  }
}

}  // namespace luminav
