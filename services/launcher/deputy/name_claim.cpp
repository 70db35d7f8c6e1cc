#include "services/launcher/deputy/name_claim.hpp"

#include <fmt/format.h>

#include "services/common/process/channels.hpp"

namespace luminav::launcher {
namespace {

constexpr std::int64_t kQuestionPeriod = 200'000;  // [us]
constexpr std::int64_t kListeningTime = 500'000;   // [us] as long as procman listens for another of its name

}  // namespace

NameClaim::NameClaim(lcm::LCM& lcm, std::string id, std::int64_t nonce)
    : lcm_(lcm), id_(std::move(id)), nonce_(nonce), subscriber_(std::in_place, lcm) {
  subscriber_->on(channels::kProcmanDiscover, &NameClaim::on_discovery, this);
  subscriber_->on(channels::kProcmanInfo, &NameClaim::on_info, this);
}

void NameClaim::tick(const Instant& now) {
  if (settled_ || conflict_) {
    return;
  }
  if (!begun_) {
    begun_ = now.steady;
    last_question_ = now.steady - kQuestionPeriod;
  }
  if (now.steady - *begun_ >= kListeningTime) {
    settled_ = true;
    subscriber_.reset();
    return;
  }
  if (now.steady - last_question_ >= kQuestionPeriod) {
    last_question_ = now.steady;
    luminav_procman::procman_discovery_t question{};
    question.utime = now.utime;
    question.transmitter_id = id_;
    question.nonce = nonce_;
    lcm_.publish(channels::kProcmanDiscover, &question);
  }
}

void NameClaim::on_discovery(const luminav_procman::procman_discovery_t& discovery) {
  if (discovery.transmitter_id == id_ && discovery.nonce != 0 && discovery.nonce < nonce_) {
    conflict_ = fmt::format("another deputy named {} is starting on this network; give one of them another --id", id_);
  }
}

void NameClaim::on_info(const luminav_procman::procman_deputy_info_t& info) {
  if (info.deputy_id == id_) {
    conflict_ = fmt::format("a deputy named {} is running on this network already; give one of them another --id", id_);
  }
}

}  // namespace luminav::launcher
