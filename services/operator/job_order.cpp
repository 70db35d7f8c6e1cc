#include "services/operator/job_order.hpp"

#include <algorithm>

#include "services/common/process/channels.hpp"

namespace luminav {

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
  } else if (message.echo_count == job_status_t::MAX_ECHOES && request_.id < ids.front()) {
    request_.id = ids.back() + 1;  // somebody's clock was ahead of ours: below all that it knows it is not acted on
  }
}

}  // namespace luminav
