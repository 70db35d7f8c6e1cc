#include "drivers/base/safety/life_sign.hpp"

namespace luminav {

bool LifeSign::heard_nothing(std::int64_t now) const {
  return done_after_ > 0.0 && last_beat_ != 0 && 1e-6 * static_cast<double>(now - last_beat_) >= silence_;
}

void LifeSign::beat(const Clock& clock) {
  constexpr std::int64_t kPeriod = 55'000;  // [us] with every third poll
  const std::int64_t now = clock.utime();
  if (!tell_guardian_ || now - last_beat_ < kPeriod) {
    return;
  }
  tell_guardian_();
  // From before the last beat until after this one: the guardian's own silence is never longer.
  was_late_ = heard_nothing(clock.utime());
  last_beat_ = now;
}

}  // namespace luminav
