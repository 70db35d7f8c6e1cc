#include "drivers/simulator/world/injected_faults.hpp"

#include <algorithm>

namespace luminav {

void InjectedFaults::start(const ScenarioEvent& event, double now) {
  const double until = now + event.duration;
  if (event.kind == EventKind::kSlip) {
    grip_ = event.factor;
    slip_until_ = until;
  } else if (event.kind == EventKind::kUnplug) {
    (event.device == "camera" ? camera_unplugged_until_ : serial_unplugged_until_) = until;
  } else if (event.kind == EventKind::kFreeze && event.device != "camera") {
    frozen_until_[event.device == "encoder_left" ? 0 : 1] = until;
  } else if (event.kind == EventKind::kDeafen || event.kind == EventKind::kStick) {
    const auto end = event.kind == EventKind::kDeafen ? &DiscFault::deaf_until : &DiscFault::stuck_until;
    for (std::size_t i = 0; i < discs_.size(); ++i) {
      const bool is_named = std::find(event.discs.begin(), event.discs.end(), static_cast<int>(i)) != event.discs.end();
      discs_[i].*end = event.discs.empty() || is_named ? until : discs_[i].*end;
    }
  }
}

double InjectedFaults::hear(int disc, double range, double now) {
  DiscFault& it = discs_[static_cast<std::size_t>(disc)];
  if (now < it.deaf_until) {
    return maximum_range_;
  }
  it.heard = now < it.stuck_until ? it.heard : range;
  return it.heard;
}

}  // namespace luminav
