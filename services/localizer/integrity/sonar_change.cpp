#include "services/localizer/integrity/sonar_change.hpp"

#include <cmath>

#include "services/localizer/integrity/wheels_at_rest.hpp"

namespace luminav {
namespace {

constexpr int kAtRest = 3;                  // scans without wheel motion: it does not roll on
constexpr std::int64_t kLongest = 4000000;  // [us] of a comparison: one by one people and chairs change everything
constexpr double kElsewhere = 0.1;          // [m] an echo is when it has moved by more
// Chosen on simulated robots that stand among four people, of whom three crowd round one that is hemmed in.
constexpr int kMinMoved = 5;         // echoes that were heard before and now
constexpr double kMinShare = 0.8;    // of those
constexpr double kMinChanged = 8.0;  // discs; an echo that came or went counts half, for slanted walls come and go

}  // namespace

bool SonarChange::look(const SonarScan& scan, const Pose2& odom_from_robot) {
  still_scans_ = are_wheels_at_rest(odom_from_robot_, odom_from_robot) ? still_scans_ + 1 : 0;
  odom_from_robot_ = odom_from_robot;
  if (still_scans_ < kAtRest) {
    return false;
  }
  if (still_scans_ == kAtRest || scan.utime - begun_ > kLongest) {
    begin(scan.utime);
  }
  for (const SonarEcho& reading : scan.readings) {
    const auto index = static_cast<std::size_t>(reading.disc);
    if (index >= discs_.size()) {
      discs_.resize(index + 1);
    }
    Disc& disc = discs_[index];
    (disc.first ? disc.last : disc.first) = reading;
  }
  const bool moved = has_moved();
  if (moved) {
    begin(scan.utime);
  }
  return moved;
}

void SonarChange::begin(std::int64_t utime) {
  begun_ = utime;
  discs_.clear();
}

bool SonarChange::has_moved() const {
  int heard = 0;  // before and now
  int moved = 0;
  int came_or_went = 0;
  for (const auto& [first, last] : discs_) {
    if (!last) {
      continue;
    }
    came_or_went += first->has_echo != last->has_echo ? 1 : 0;
    if (first->has_echo && last->has_echo) {
      ++heard;
      moved += std::abs(last->range - first->range) > kElsewhere ? 1 : 0;
    }
  }
  return moved >= kMinMoved && moved >= kMinShare * heard && moved + 0.5 * came_or_went >= kMinChanged;
}

}  // namespace luminav
