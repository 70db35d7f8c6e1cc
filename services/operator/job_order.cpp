#include "services/operator/job_order.hpp"

#include <algorithm>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

/// The newest id that the job service knows; 0 = none.
std::int64_t newest_id(const job_status_t& status) {
  std::int64_t newest = status.echo_ids.empty() ? 0 : status.echo_ids.back();
  for (const job_state_t& job : status.jobs) {
    newest = std::max(newest, job.id);
  }
  return newest;
}

/// Whether the job service acts on no request of this id, as job_status_t says.
bool is_too_old(std::int64_t id, const job_status_t& status) {
  return (status.echo_count == job_status_t::MAX_ECHOES && id < status.echo_ids.front()) ||
         newest_id(status) - id > job_status_t::MAX_AGE;
}

}  // namespace

JobListener::JobListener(lcm::LCM& lcm) : subscriber_(lcm) {
  subscriber_.on(channels::kJobStatus, &JobListener::on_job_status, this);
}

JobOrder::JobOrder(lcm::LCM& lcm, const job_t& request, std::optional<CommandKey> key)
    : commands_(lcm, key), request_(request), subscriber_(lcm) {
  subscriber_.on(channels::kJobStatus, &JobOrder::on_job_status, this);
}

void JobOrder::tick() {
  ++ticks_;
  if (!objection_) {
    commands_.publish(channels::kJob, request_);
  }
}

void JobOrder::on_job_status(const job_status_t& message) {
  if (objection_) {
    return;
  }
  const auto& ids = message.echo_ids;
  const auto found = std::find(ids.begin(), ids.end(), request_.id);
  if (found != ids.end()) {
    objection_ = message.objections[static_cast<std::size_t>(found - ids.begin())];
  } else if (is_too_old(request_.id, message)) {
    request_.id = newest_id(message) + 1;  // somebody's clock was ahead of ours
  }
}

}  // namespace luminav
