#include "services/common/building/zone_timetable.hpp"

#include <algorithm>
#include <utility>

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]

}  // namespace

ZoneTimetable::ZoneTimetable(std::vector<Zone> zones, LocalClock clock) : clock_(std::move(clock)) {
  set(std::move(zones));
}

void ZoneTimetable::set(std::vector<Zone> zones) {
  all_ = std::move(zones);
  has_hours_ = std::any_of(all_.begin(), all_.end(), [](const Zone& zone) { return !are_always(zone.hours); });
  const bool knows_time = has_hours_ && last_second_;
  take(knows_time ? ends_at(clock_(*last_second_ * kSecond)) : Ends(all_.size(), ""));
}

bool ZoneTimetable::tell(std::int64_t utime) {
  if (last_second_ == utime / kSecond) {
    return false;
  }
  last_second_ = utime / kSecond;
  Ends ends = has_hours_ ? ends_at(clock_(utime)) : ends_;
  if (ends == ends_) {
    return false;
  }
  take(std::move(ends));
  return true;
}

ZoneTimetable::Ends ZoneTimetable::ends_at(const LocalTime& now) const {
  Ends ends;
  for (const Zone& zone : all_) {
    ends.push_back(hold(zone.hours, now) ? std::optional(end_of(zone.hours, now)) : std::nullopt);
  }
  return ends;
}

void ZoneTimetable::take(Ends ends) {
  ends_ = std::move(ends);
  in_force_.clear();
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (ends_[i]) {
      in_force_.push_back(all_[i]);
      in_force_.back().until = *ends_[i];
    }
  }
}

}  // namespace luminav
