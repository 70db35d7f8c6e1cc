#include "tests/system/faults/truth_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr double kStandingLinear = 0.02;   // [m/s]
constexpr double kStandingAngular = 0.02;  // [rad/s]
constexpr std::int64_t kMemory = 60'000'000;
constexpr std::int64_t kStands = 50'000;  // [us] long enough to call it standing
constexpr std::int64_t kMoves = 100'000;  // [us] long enough to call it moving

bool moves(const sim_truth_t& truth) {
  return std::abs(truth.linear) >= kStandingLinear || std::abs(truth.angular) >= kStandingAngular;
}

}  // namespace

TruthWatch::TruthWatch(lcm::LCM& lcm) : subscriber_(lcm) {
  subscriber_.on(channels::kSimTruth, &TruthWatch::on_truth, this);
}

void TruthWatch::on_truth(const sim_truth_t& truth) {
  if (newest_ && truth.session == newest_->session) {
    longest_gap_ = std::max(longest_gap_, static_cast<double>(truth.utime - newest_->utime) * 1e-6);
    driven_ += std::hypot(truth.x - newest_->x, truth.y - newest_->y);
  }
  if (newest_ && truth.contacts > newest_->contacts) {
    const sim_truth_t before = *std::exchange(newest_, truth);
    last_contact_ = fmt::format("at ({:.2f}, {:.2f}) with {:.2f} m/s and {:.2f} rad/s, nearest person {:.2f} m",
                                truth.x, truth.y, before.linear, before.angular, nearest_person());
  }
  if (first_ == 0) {
    first_ = truth.utime;
  }
  newest_ = truth;
  moments_.push_back({truth.utime, moves(truth)});
  while (moments_.front().utime < truth.utime - kMemory) {
    moments_.pop_front();
  }
}

bool TruthWatch::stands() const {
  return newest_ && !moves(*newest_);
}

std::optional<std::int64_t> TruthWatch::first_stretch(std::int64_t utime, bool wanted, std::int64_t length) const {
  std::optional<std::int64_t> since;
  for (const Moment& moment : moments_) {
    if (moment.utime < utime || moment.moves != wanted) {
      since.reset();
      continue;
    }
    since = since.value_or(moment.utime);
    if (moment.utime - *since >= length) {
      return since;
    }
  }
  return std::nullopt;
}

std::optional<std::int64_t> TruthWatch::stood_at(std::int64_t utime) const {
  return first_stretch(utime, false, kStands);
}

std::optional<std::int64_t> TruthWatch::moved_at(std::int64_t utime) const {
  return first_stretch(utime, true, kMoves);
}

double TruthWatch::elapsed() const {
  return newest_ ? static_cast<double>(newest_->utime - first_) * 1e-6 : 0.0;
}

double TruthWatch::nearest_person() const {
  double nearest = 100.0;
  for (int i = 0; newest_ && i < newest_->people; ++i) {
    const auto index = static_cast<std::size_t>(i);
    nearest = std::min(nearest, std::hypot(static_cast<double>(newest_->person_x[index]) - newest_->x,
                                           static_cast<double>(newest_->person_y[index]) - newest_->y));
  }
  return nearest;
}

double TruthWatch::take_longest_gap() {
  const double gap = longest_gap_;
  longest_gap_ = 0.0;
  return gap;
}

}  // namespace luminav
