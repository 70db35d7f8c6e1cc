#include "drivers/base/safety/velocity_gate.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr std::int64_t kFutureSlack = 50'000;       // [us] a stamp of ours cannot lie ahead
constexpr std::int64_t kSessionMemory = 1'000'000;  // [us] without an accepted command
constexpr double kSidewaysSlack = 1e-6;             // [m/s]

}  // namespace

std::string VelocityGate::judge(const Offer& offer, std::int64_t now) const {
  if (!std::isfinite(offer.linear) || !std::isfinite(offer.sideways) || !std::isfinite(offer.angular)) {
    return "not a number";
  }
  if (std::abs(offer.sideways) > kSidewaysSlack) {
    return "asks a differential drive to move sideways";
  }
  if (offer.utime > now + kFutureSlack || offer.session > now + kFutureSlack) {
    return "answers a message from the future";
  }
  if (static_cast<double>(now - offer.utime) > params_.timeout * 1e6) {
    return "too old";
  }
  if (offer.utime < not_before_) {
    return "from before the last stop";
  }
  if (offer.session < session_ || (offer.session == session_ && offer.sequence <= sequence_)) {
    return "out of sequence";
  }
  return {};
}

std::string VelocityGate::offer(const Offer& offer, std::int64_t now) {
  if (now - accepted_at_ > kSessionMemory) {
    session_ = 0;  // its controller is gone: what a recording said in between must not lock the next one out
    sequence_ = 0;
  }
  std::string why = judge(offer, now);
  if (!why.empty()) {
    ++refused_;
    return why;
  }
  session_ = offer.session;
  sequence_ = offer.sequence;
  accepted_at_ = now;
  utime_ = std::min(offer.utime, now);
  velocity_ = {offer.linear, offer.angular};
  return {};
}

void VelocityGate::clear(std::int64_t now) {
  utime_ = 0;
  not_before_ = now;
}

void VelocityGate::set_limits(double maximum_linear, double maximum_angular) {
  params_.maximum_linear = maximum_linear;
  params_.maximum_angular = maximum_angular;
}

bool VelocityGate::is_fresh(std::int64_t now) const {
  return utime_ != 0 && static_cast<double>(now - utime_) <= params_.timeout * 1e6;
}

DriveVelocity VelocityGate::velocity(std::int64_t now) const {
  if (!is_fresh(now)) {
    return {};
  }
  // Both by the same factor: what was judged to be free is the arc, and a tighter one swings corners elsewhere.
  double factor = 1.0;
  if (std::abs(velocity_.linear) > params_.maximum_linear) {
    factor = params_.maximum_linear / std::abs(velocity_.linear);
  }
  if (std::abs(velocity_.angular) > params_.maximum_angular) {
    factor = std::min(factor, params_.maximum_angular / std::abs(velocity_.angular));
  }
  return {factor * velocity_.linear, factor * velocity_.angular};
}

}  // namespace luminav
