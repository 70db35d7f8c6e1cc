#include "services/jobs/job_queue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace luminav {

const char* name_of(JobKind kind) {
  switch (kind) {
    case JobKind::kGo:
      return "go";
    case JobKind::kCarry:
      return "carry";
    case JobKind::kTour:
      return "tour";
    case JobKind::kHome:
      return "home";
    case JobKind::kGuide:
      return "guide";
  }
  return "";
}

std::string name_of(const JobStop& stop) {
  return stop.place.empty() ? fmt::format("({:.1f}, {:.1f})", stop.pose.x, stop.pose.y) : stop.place;
}

std::int64_t JobQueue::newest_id() const {
  std::int64_t newest = table_.echoes.empty() ? 0 : table_.echoes.back().id;
  for (const Job& job : table_.jobs) {
    newest = std::max(newest, job.id);
  }
  return newest;
}

bool JobQueue::is_known(std::int64_t request) const {
  const std::vector<RequestEcho>& echoes = table_.echoes;
  const auto by_id = [](const RequestEcho& echo, std::int64_t id) { return echo.id < id; };
  const auto found = std::lower_bound(echoes.begin(), echoes.end(), request, by_id);
  const bool is_echoed = found != echoes.end() && found->id == request;
  const bool is_too_old = (echoes.size() == kMaxEchoes && found == echoes.begin()) || newest_id() - request > kMaxAge;
  const bool is_job =
      std::any_of(table_.jobs.begin(), table_.jobs.end(), [&](const Job& j) { return j.id == request; });
  return is_echoed || is_too_old || is_job;
}

void JobQueue::echo(std::int64_t request, const std::string& objection) {
  std::vector<RequestEcho>& echoes = table_.echoes;
  std::erase_if(echoes, [&](const RequestEcho& echo) { return echo.id == request; });
  const auto after = std::find_if(echoes.begin(), echoes.end(), [&](const RequestEcho& e) { return e.id > request; });
  echoes.insert(after, {request, objection});
  if (echoes.size() > kMaxEchoes) {
    echoes.erase(echoes.begin());
  }
}

bool JobQueue::is_full() const {
  const auto waiting =
      std::count_if(table_.jobs.begin(), table_.jobs.end(), [](const Job& job) { return !job.is_over(); });
  return static_cast<std::size_t>(waiting) >= kMaxWaiting;
}

void JobQueue::add(Job job) {
  table_.jobs.push_back(std::move(job));
}

void JobQueue::withdraw(std::int64_t id) {
  std::erase_if(table_.jobs, [&](const Job& job) { return job.id == id; });
  if (table_.active == id) {
    table_.active = 0;
  }
}

std::int64_t JobQueue::free_id(std::int64_t utime) const {
  std::int64_t id = std::max<std::int64_t>(utime, 1);
  for (const Job& job : table_.jobs) {
    id = std::max(id, job.id + 1);
  }
  return id;
}

const Job* JobQueue::find(std::int64_t id) const {
  const auto found = std::find_if(table_.jobs.begin(), table_.jobs.end(), [&](const Job& job) { return job.id == id; });
  return id == 0 || found == table_.jobs.end() ? nullptr : &*found;
}

Job* JobQueue::find(std::int64_t id) {
  return const_cast<Job*>(std::as_const(*this).find(id));
}

Job* JobQueue::next() {
  Job* best = nullptr;
  for (Job& job : table_.jobs) {
    if (job.state == JobState::kQueued && job.id != table_.active &&
        (best == nullptr || job.priority > best->priority)) {
      best = &job;
    }
  }
  return best;
}

void JobQueue::finish(Job& job, JobState state, const std::string& sentence) {
  job.state = state;
  job.sentence = sentence;
  job.question.reset();
  job.goal_id = 0;
  if (table_.active == job.id) {
    table_.active = 0;
  }
  // the last to end stands last, so that the first of them is the oldest
  const std::int64_t id = job.id;
  const auto found = std::find_if(table_.jobs.begin(), table_.jobs.end(), [&](const Job& j) { return j.id == id; });
  std::rotate(found, found + 1, table_.jobs.end());
  const auto is_over = [](const Job& j) { return j.is_over(); };
  if (static_cast<std::size_t>(std::count_if(table_.jobs.begin(), table_.jobs.end(), is_over)) > kMaxOver) {
    table_.jobs.erase(std::find_if(table_.jobs.begin(), table_.jobs.end(), is_over));
  }
}

std::vector<const Job*> JobQueue::in_order() const {
  std::vector<const Job*> waiting;
  std::vector<const Job*> over;
  for (const Job& job : table_.jobs) {
    (job.is_over() ? over : waiting).push_back(&job);
  }
  const auto rank = [&](const Job* job) {
    return std::tuple(job->id != table_.active, job->state == JobState::kAsking, -job->priority);
  };
  std::stable_sort(waiting.begin(), waiting.end(), [&](const Job* a, const Job* b) { return rank(a) < rank(b); });
  waiting.insert(waiting.end(), over.rbegin(), over.rend());
  return waiting;
}

}  // namespace luminav
