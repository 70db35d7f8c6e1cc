#include "services/mapper/sonar/echo_filter.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kDistanceShare = 0.1;  // of the range, added: a cone is wider farther away
constexpr int kNeighbours = 1;          // discs to either side that may confirm

}  // namespace

EchoFilter::EchoFilter(const EchoFilterParams& params, int discs) : params_(params), discs_(discs) {
  if (discs < 1 || !(params.memory > 0.0) || !(params.distance > 0.0)) {
    throw std::invalid_argument("echo filter: memory and distance must be above 0, discs at least 1");
  }
  clear();
}

void EchoFilter::clear() {
  echoes_.assign(static_cast<std::size_t>(discs_) * kRemembered, Echo{});
  next_.assign(static_cast<std::size_t>(discs_), 0);
}

bool EchoFilter::confirm(int disc, std::int64_t utime, const Eigen::Vector2d& point, double range) {
  assert(disc >= 0 && disc < discs_);
  const auto oldest = utime - microseconds_of(params_.memory);
  bool confirmed = false;
  for (int offset = -kNeighbours; offset <= kNeighbours && !confirmed; ++offset) {
    // the ring closes behind the robot
    const int other = ((disc + offset) % discs_ + discs_) % discs_;
    for (std::size_t i = 0; i < kRemembered; ++i) {
      const Echo& echo = echoes_[static_cast<std::size_t>(other) * kRemembered + i];
      const double limit = params_.distance + kDistanceShare * std::min(range, echo.range);
      if (echo.utime >= oldest && echo.utime != 0 && (echo.point - point).squaredNorm() <= limit * limit) {
        confirmed = true;
        break;
      }
    }
  }
  std::size_t& next = next_[static_cast<std::size_t>(disc)];
  echoes_[static_cast<std::size_t>(disc) * kRemembered + next] = {utime, point, range};
  next = (next + 1) % kRemembered;
  return confirmed;
}

}  // namespace luminav
