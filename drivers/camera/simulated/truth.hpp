#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav::simulated {

/// The values of sim_truth_t::LAMP_*.
enum class LampState : std::int8_t { kOff = 0, kOn = 1, kHalf = 2, kFlicker = 3 };

/// A fixture pushed out of its drawn true place.
struct MovedLamp {
  int index = 0;       // in the order of the building's file
  double dx = 0.0;     // [m] world
  double dy = 0.0;     // [m]
  double theta = 0.0;  // [rad]
  friend bool operator==(const MovedLamp&, const MovedLamp&) = default;
};

/// What the simulated camera takes from one SIM_TRUTH.
struct TruthSample {
  std::int64_t utime = 0;    // [us]
  std::int64_t session = 0;  // a new value: the simulator started anew
  Pose2 world_from_robot;
  double roll = 0.0;   // [rad] of the floor, robot frame
  double pitch = 0.0;  // [rad]
  bool camera_unplugged = false;
  double daylight = 0.0;         // 0..1
  std::vector<LampState> lamps;  // in the order of the building's file
  std::vector<MovedLamp> moved;
};

/// Pose of the robot in space at one instant.
struct TruePose {
  Pose2 world_from_robot;
  double roll = 0.0;   // [rad]
  double pitch = 0.0;  // [rad]
};

/// The last half second of truth.
class TruthBuffer {
 public:
  /// True if the sample was taken; false when it is not newer than the last. Another session empties the buffer first.
  bool add(const TruthSample& sample);
  void clear() { samples_.clear(); }

  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] const TruthSample& newest() const { return samples_.back(); }
  /// The first sample not before a time [us] that the buffer reaches.
  [[nodiscard]] const TruthSample& from(double utime) const { return *first_from(utime); }
  /// Between the two samples around a time [us]; nothing outside the buffer. Where the robot jumped between them it
  /// is at the nearer one's place.
  [[nodiscard]] std::optional<TruePose> at(double utime) const;

 private:
  static constexpr std::int64_t kKept = 500'000;  // [us]
  static constexpr double kJump = 0.5;            // [m] from one sample to the next: nobody moves that fast
  [[nodiscard]] std::deque<TruthSample>::const_iterator first_from(double utime) const;

  std::deque<TruthSample> samples_;
};

}  // namespace luminav::simulated
