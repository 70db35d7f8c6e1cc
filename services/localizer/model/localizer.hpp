#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

/// Finds and follows the robot's pose. Two users: the paper's method and the modern one. Inputs come in the order they
/// arrive; images may be late, and are placed at their own time by odometry.
class Localizer {
 public:
  virtual ~Localizer() = default;
  virtual void add_odometry(const OdometryReading& reading) = 0;
  virtual void add_frame(const SightingFrame& frame) = 0;
  virtual void add_sonar(const SonarScan& scan) = 0;
  /// With the motors off a hand may move the robot.
  virtual void set_motors_enabled(bool enabled) = 0;
  /// A pose from outside that is to be weighed against what is seen.
  virtual void add_guess(const PoseBelief& guess) = 0;
  /// A pose from before a restart, carried to now by odometry. Held for true once the first sighting agrees.
  virtual void recall(const PoseBelief& belief) = 0;

  /// Carried forward to the newest odometry.
  [[nodiscard]] virtual LocalizerEstimate estimate() const = 0;
  /// Heaviest first; weights sum to at most 1.
  [[nodiscard]] virtual std::vector<WeightedPose> hypotheses(std::size_t max) const = 0;
  /// A sample of the particles; empty where there are none.
  [[nodiscard]] virtual std::vector<WeightedPose> particles(std::size_t max) const = 0;
  /// Images that came too late or too early to be used.
  [[nodiscard]] virtual std::int64_t frames_dropped() const = 0;
  /// Stamp [us] of the last image that was used; 0 = none since the start.
  [[nodiscard]] virtual std::int64_t last_frame_used() const = 0;
};

}  // namespace luminav
