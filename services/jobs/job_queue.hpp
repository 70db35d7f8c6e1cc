#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "services/jobs/job.hpp"

namespace luminav {

/// A request that was acted on, and why it was not done; "" = done.
struct RequestEcho {
  std::int64_t id = 0;
  std::string objection;
};

/// All that must survive the process.
struct JobTable {
  std::vector<Job> jobs;              // in the order of their coming
  std::int64_t active = 0;            // id of the job under way; 0 = none
  std::int64_t open_goal = 0;         // id of a GOAL that may still move the robot; 0 = none
  std::vector<RequestEcho> echoes;    // of the newest requests, by rising ids
  std::map<std::string, int> toured;  // day on which a stored tour was started last
};

/// The jobs in their order, and the requests that were acted on already: a repeated one changes nothing, also after a
/// restart. Holds up to kMaxWaiting jobs that are not over, and the last kMaxOver that are.
class JobQueue {
 public:
  static constexpr std::size_t kMaxWaiting = 20;
  static constexpr std::size_t kMaxOver = 10;
  static constexpr std::size_t kMaxEchoes = 32;         // as job_status_t says
  static constexpr std::int64_t kMaxAge = 600'000'000;  // [us] likewise; ids are taken from the clock

  [[nodiscard]] const JobTable& table() const { return table_; }
  void restore(JobTable table) { table_ = std::move(table); }

  /// Acted on already, or older than all that is remembered, or ten minutes older than the newest of it: its sender has
  /// long given up, and whoever plays a log sends it once more.
  [[nodiscard]] bool is_known(std::int64_t request) const;
  void echo(std::int64_t request, const std::string& objection);

  [[nodiscard]] bool is_full() const;
  void add(Job job);
  /// As if it had never come.
  void withdraw(std::int64_t id);
  /// An id for a job that nobody requested, from a stamp [us].
  [[nodiscard]] std::int64_t free_id(std::int64_t utime) const;

  [[nodiscard]] Job* find(std::int64_t id);
  [[nodiscard]] const Job* find(std::int64_t id) const;
  [[nodiscard]] Job* active() { return find(table_.active); }
  [[nodiscard]] const Job* active() const { return find(table_.active); }
  /// The one whose turn it is: of the queued ones that with the highest priority, then the oldest; null = none.
  [[nodiscard]] Job* next();
  void activate(const Job& job) { table_.active = job.id; }
  void deactivate() { table_.active = 0; }
  /// Ends a job and forgets the oldest of those that are over.
  void finish(Job& job, JobState state, const std::string& sentence);

  void open_goal(std::int64_t id) { table_.open_goal = id; }
  void start_tour(const std::string& name, int day) { table_.toured[name] = day; }

  /// The one under way, the queue in its order, those that ask, then what is over, the newest first.
  [[nodiscard]] std::vector<const Job*> in_order() const;

 private:
  /// Of all requests and jobs that are remembered; 0 = none are.
  [[nodiscard]] std::int64_t newest_id() const;

  JobTable table_;
};

}  // namespace luminav
