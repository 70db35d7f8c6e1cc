#include "services/launcher/deputy/respawn_policy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace luminav::launcher {

RespawnPolicy::RespawnPolicy(const RespawnParams& params) : params_(params) {
  const bool sensible = params.first_delay > 0 && params.longest_delay >= params.first_delay && params.limit >= 0 &&
                        params.settled_after > 0;
  if (!sensible) {
    throw std::invalid_argument(
        fmt::format("respawn: first_delay {} s, longest_delay {} s, settled_after {} s, limit {}: must be > 0, not "
                    "below the first, > 0, >= 0",
                    params.first_delay, params.longest_delay, params.settled_after, params.limit));
  }
}

std::optional<std::int64_t> RespawnPolicy::delay_after(std::int64_t lived) {
  if (static_cast<double>(lived) >= params_.settled_after * 1e6) {
    deaths_ = 0;
  }
  if (deaths_ >= params_.limit) {
    return std::nullopt;
  }
  const double delay = std::min(params_.longest_delay, params_.first_delay * std::pow(2.0, deaths_));
  ++deaths_;
  return static_cast<std::int64_t>(delay * 1e6);
}

}  // namespace luminav::launcher
