#include "drivers/contract/stream_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kJudgeable = 2.0;   // [s] of messages
constexpr double kRateSlack = 0.05;  // of the rate
constexpr double kPaceSlack = 0.3;   // [s] a network may hold messages back so long
constexpr double kPaceShare = 0.02;  // of the time: clocks of two hosts
constexpr double kLoss = 0.02;       // of the messages: datagrams may be lost

double seconds(std::int64_t microseconds) {
  return 1e-6 * static_cast<double>(microseconds);
}

}  // namespace

StreamWatch::StreamWatch(const StreamParams& params)
    : params_(params),
      stamps_(params.channel + ": stamps grow, by a clock that is never set back"),
      sequence_(params.channel + ": sequence counts up by one within a session") {}

void StreamWatch::hear(const StreamHead& head) {
  ++count_;
  if (count_ == 1) {
    first_ = last_ = head;
    return;
  }
  if (head.utime <= last_.utime) {
    stamps_.breach(fmt::format("{:.3f} s back", seconds(last_.utime - head.utime)));
  } else {
    stamps_.keep();
    longest_gap_ = std::max(longest_gap_, seconds(head.utime - last_.utime));
  }
  if (head.session == last_.session) {
    if (head.sequence <= last_.sequence) {
      sequence_.breach(fmt::format("{} after {}", head.sequence, last_.sequence));
    } else {
      sequence_.keep();
      lost_ += head.sequence - last_.sequence - 1;
    }
  }
  last_ = head;
}

double StreamWatch::span(std::int64_t StreamHead::*time) const {
  return seconds(last_.*time - first_.*time);
}

std::vector<Clause> StreamWatch::clauses() const {
  Clause rate(
      fmt::format("{}: {:.0f} Hz or more, no gap above {:.2f} s", params_.channel, params_.rate, params_.longest_gap));
  Clause pace(params_.channel + ": stamps advance as time does");
  Clause sequence = sequence_;
  const double arrivals = span(&StreamHead::arrival);
  const double stamps = span(&StreamHead::utime);
  if (count_ < 2) {
    rate.breach("none came");
  } else if (arrivals >= kJudgeable) {
    const double measured = static_cast<double>(count_ - 1) / arrivals;
    rate.judge(measured >= (1.0 - kRateSlack) * params_.rate && longest_gap_ <= params_.longest_gap,
               fmt::format("{:.1f} Hz, longest gap {:.2f} s", measured, longest_gap_));
    pace.judge(std::abs(stamps - arrivals) <= kPaceSlack + kPaceShare * arrivals,
               fmt::format("{:.2f} s in {:.2f} s", stamps, arrivals));
    if (static_cast<double>(lost_) > kLoss * static_cast<double>(count_)) {
      sequence.breach(fmt::format("{} of {} are missing", lost_, count_ + lost_));
    }
  }
  return {rate, stamps_, pace, sequence};
}

}  // namespace luminav
