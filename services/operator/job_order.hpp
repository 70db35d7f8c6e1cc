#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/job_t.hpp>
#include <optional>
#include <string>

#include "services/common/network/command_seal.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// Hears the queue of jobs.
class JobListener {
 public:
  explicit JobListener(lcm::LCM& lcm);

  /// The newest word; nothing = no job service has spoken.
  [[nodiscard]] const std::optional<job_status_t>& status() const { return status_; }

 private:
  void on_job_status(const job_status_t& message) { status_ = message; }

  std::optional<job_status_t> status_;
  Subscriber subscriber_;
};

/// One request to the job service, repeated with each `tick` until JOB_STATUS echoes its id. Knows no clock: the owner
/// calls `tick` at 5 Hz.
class JobOrder {
 public:
  /// `request.id` must be set.
  JobOrder(lcm::LCM& lcm, const job_t& request, std::optional<CommandKey> key = {});

  /// A fifth of a second has passed.
  void tick();
  /// Why it was not done, "" = done; nothing before the answer.
  [[nodiscard]] const std::optional<std::string>& objection() const { return objection_; }
  /// 5 s without an answer.
  [[nodiscard]] bool is_unanswered() const { return !objection_ && ticks_ > kAnswerTicks; }
  /// Of a new job: its id, once it is taken.
  [[nodiscard]] std::int64_t id() const { return request_.id; }

 private:
  static constexpr int kAnswerTicks = 25;

  void on_job_status(const job_status_t& message);

  CommandPublisher commands_;
  job_t request_;
  int ticks_ = 0;
  std::optional<std::string> objection_;
  Subscriber subscriber_;
};

}  // namespace luminav
