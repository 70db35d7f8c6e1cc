#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/job_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/world/world.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/runs/job_plan.hpp"

namespace luminav {

/// Plays the people of a scenario's jobs: who orders them, loads, follows, answers questions, and now and then stands
/// in the dock. Requests are repeated until they are echoed, as scripts/job does. Its time is SIM_TRUTH's.
class JobPeople {
 public:
  JobPeople(lcm::LCM& lcm, const Scenario& scenario, DrawnJobs drawn, World& world);

  [[nodiscard]] const DrawnJobs& drawn() const { return drawn_; }
  /// What was ordered by a request, by its id; null = nobody ordered it.
  [[nodiscard]] const PlannedJob* ordered(std::int64_t id) const;
  [[nodiscard]] std::size_t orders() const { return ordered_.size(); }
  /// Orders that the service said it has.
  [[nodiscard]] const std::vector<std::int64_t>& promised() const { return promised_; }
  /// Requests that it objected to, with its sentence.
  [[nodiscard]] const std::vector<std::string>& objections() const { return objections_; }
  [[nodiscard]] int answers() const { return answers_; }
  /// All jobs were ordered, and all are over.
  [[nodiscard]] bool is_finished() const;

 private:
  struct Request {
    job_t message{};
    std::int64_t sent = 0;  // [us] last
  };
  /// What a person has noticed of a job.
  struct Notice {
    std::pair<int, int> state{-1, -1};  // and stop
    double since = 0.0;                 // [s] it has been so
    bool is_dealt_with = false;
    int answers = 0;
    bool is_visited = false;
  };

  void on_truth(const sim_truth_t& truth);
  void on_jobs(const job_status_t& status);
  void order();
  void send(std::int64_t utime);
  void ask(const job_state_t& job, std::int8_t action, const std::string& word);
  void look_after(const job_state_t& job);
  void hand_over(const job_state_t& job, Notice& notice);
  void answer(const job_state_t& job, Notice& notice);
  void come_along(const job_state_t& job, Notice& notice);
  void stand_in_dock(Notice& notice);

  lcm::LCM& lcm_;
  Scenario scenario_;
  DrawnJobs drawn_;
  World& world_;
  RandomStream random_;
  std::map<std::int64_t, const PlannedJob*> ordered_;
  std::vector<std::int64_t> promised_;
  std::vector<std::string> objections_;
  std::vector<Request> open_;
  std::map<std::int64_t, Notice> notices_;
  std::optional<job_status_t> status_;
  std::int64_t first_ = 0;  // [us]
  std::int64_t last_id_ = 0;
  double elapsed_ = 0.0;       // [s]
  double dock_free_at_ = 0.0;  // [s]
  int answers_ = 0;
  Subscriber subscriber_;
};

}  // namespace luminav
