#include "drivers/camera/simulated/truth.hpp"

#include <algorithm>

namespace luminav::simulated {

bool TruthBuffer::add(const TruthSample& sample) {
  if (!samples_.empty() && sample.session != samples_.back().session) {
    samples_.clear();
  }
  if (!samples_.empty() && sample.utime <= samples_.back().utime) {
    return false;
  }
  samples_.push_back(sample);
  while (samples_.front().utime < sample.utime - kKept) {
    samples_.pop_front();
  }
  return true;
}

std::deque<TruthSample>::const_iterator TruthBuffer::first_from(double utime) const {
  return std::lower_bound(samples_.begin(), samples_.end(), utime, [](const TruthSample& sample, double time) {
    return static_cast<double>(sample.utime) < time;
  });
}

std::optional<TruePose> TruthBuffer::at(double utime) const {
  if (samples_.empty() || utime < static_cast<double>(samples_.front().utime) ||
      utime > static_cast<double>(samples_.back().utime)) {
    return std::nullopt;
  }
  const auto after = first_from(utime);
  const TruthSample& b = *after;
  if (after == samples_.begin()) {
    return TruePose{b.world_from_robot, b.roll, b.pitch};
  }
  const TruthSample& a = *(after - 1);
  double share = (utime - static_cast<double>(a.utime)) / static_cast<double>(b.utime - a.utime);
  const Eigen::Vector2d step = b.world_from_robot.position() - a.world_from_robot.position();
  if (step.norm() > kJump) {
    share = share < 0.5 ? 0.0 : 1.0;
  }
  const double turn = wrap_angle(b.world_from_robot.theta - a.world_from_robot.theta);
  return TruePose{{a.world_from_robot.x + share * step.x(), a.world_from_robot.y + share * step.y(),
                   wrap_angle(a.world_from_robot.theta + share * turn)},
                  a.roll + share * (b.roll - a.roll),
                  a.pitch + share * (b.pitch - a.pitch)};
}

}  // namespace luminav::simulated
