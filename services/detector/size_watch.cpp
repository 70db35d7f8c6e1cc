#include "services/detector/size_watch.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kWrong = 0.06;  // share: heights within 2 % and bloom stay below
constexpr double kAgree = 0.03;  // share within which the middle half must lie

}  // namespace

void SizeWatch::add(std::span<const Detection> detections) {
  for (const Detection& detection : detections) {
    if (detection.scale) {
      scales_[next_] = *detection.scale;
      next_ = (next_ + 1) % kCount;
      seen_ = std::min(seen_ + 1, kCount);
    }
  }
}

std::string SizeWatch::complaint() const {
  if (seen_ < kCount) {
    return "";
  }
  std::array<double, kCount> sorted = scales_;
  std::sort(sorted.begin(), sorted.end());
  const double wrong = sorted[kCount / 2] - 1.0;
  if (std::abs(wrong) < kWrong || sorted[3 * kCount / 4] - sorted[kCount / 4] > kAgree) {
    return "";
  }
  return "lamps look " + std::to_string(std::lround(100.0 * std::abs(wrong))) + " % " +
         (wrong > 0.0 ? "longer" : "shorter") + " than the file says: is the ceiling height right?";
}

}  // namespace luminav
