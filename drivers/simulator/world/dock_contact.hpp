#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/world/scenario.hpp"

namespace luminav {

/// Whether the robot's contacts have met those of the charger: drawn each time it comes to stand in the dock.
class DockContact {
 public:
  DockContact(const std::optional<Dock>& dock, std::uint64_t seed) : dock_(dock), random_(seed, "dock") {}

  /// Where the robot is, and whether it stands.
  void step(const Pose2& world_from_robot, bool stands, bool carried) {
    if (!dock_) {
      return;
    }
    if (carried || distance(world_from_robot, dock_->pose) > dock_->reach ||
        std::abs(wrap_angle(world_from_robot.theta - dock_->pose.theta)) > dock_->heading) {
      has_met_.reset();
    } else if (!has_met_ && stands) {
      has_met_ = random_.happens(dock_->contact);
    }
  }
  [[nodiscard]] bool has_met() const { return has_met_.value_or(false); }

 private:
  std::optional<Dock> dock_;
  RandomStream random_;
  std::optional<bool> has_met_;  // nothing: away, or still coming
};

}  // namespace luminav
