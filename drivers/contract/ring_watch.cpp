#include "drivers/contract/ring_watch.hpp"

#include <fmt/format.h>

namespace luminav {

void RingWatch::hear(const sonar_t& message) {
  const std::size_t count = ring_.robot_from_sonar.size();
  const bool is_whole = message.range.size() == count && message.has_echo.size() == count &&
                        message.fresh.size() == count && message.range_utime.size() == count;
  discs_.judge(is_whole, fmt::format("{} of {}", message.range.size(), count));
  for (std::size_t i = 0; is_whole && i < count; ++i) {
    judge_disc(message, i);
  }
}

void RingWatch::judge_disc(const sonar_t& message, std::size_t disc) {
  constexpr float kRounding = 0.01F;  // [m]
  const auto maximum = static_cast<float>(ring_.maximum_range);
  const float range = message.range[disc];
  const bool is_within = range >= 0.0F && range <= maximum + kRounding;
  ranges_.judge(is_within && (message.has_echo[disc] || range >= maximum - kRounding),
                fmt::format("disc {}: {:.2f} m{}", disc, range, message.has_echo[disc] ? "" : " without an echo"));
  const std::int64_t fired = message.range_utime[disc];
  const bool is_new = fired != utime_[disc];
  const bool first = utime_[disc] == 0;  // fired before anybody listened, perhaps
  firings_.judge(fired >= utime_[disc] && fired <= message.utime && (first || is_new == (message.fresh[disc] != 0)),
                 fmt::format("disc {}: {}, {:.3f} s after the firing before", disc,
                             message.fresh[disc] ? "fresh" : "old", 1e-6 * static_cast<double>(fired - utime_[disc])));
  utime_[disc] = fired;
}

std::vector<Clause> RingWatch::clauses() const {
  return ring_.robot_from_sonar.empty() ? std::vector<Clause>{} : std::vector{discs_, ranges_, firings_};
}

}  // namespace luminav
