#pragma once

#include <cstdint>
#include <optional>

#include "drivers/create2/oi/sensor_reading.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

struct WheelOdometryParams {
  double wheel_base = 0.235;                              // [m]
  double distance_per_count = 1e-3 * kPi * 72.0 / 508.8;  // [m] wheels of 72 mm, 508.8 counts a turn
  double maximum_speed = 0.75;                            // [m/s] of a wheel: a larger step is refused
};

/// Odometry from the wrapping 16-bit counts of both encoders.
class WheelOdometry {
 public:
  enum class Verdict {
    kAccepted,
    kRefused,  // more than the wheels can do: a damaged frame
    kJumped,   // several agree on other counts: the robot was reset; a new reference, motion across it unknown
  };

  explicit WheelOdometry(const WheelOdometryParams& params) : params_(params) {}

  /// The next reading is a new reference; the pose stays.
  void restart() { last_.reset(); }
  Verdict update(const SensorReading& reading, std::int64_t utime);
  /// Takes the mean twist since the last call as the measured one: a single frame of 15 ms counts too coarsely.
  void measure_twist(std::int64_t utime);

  [[nodiscard]] const Pose2& odom_from_robot() const { return odom_from_robot_; }
  [[nodiscard]] double linear() const { return linear_; }    // [m/s]
  [[nodiscard]] double angular() const { return angular_; }  // [rad/s]

 private:
  struct Counts {
    std::uint16_t left = 0;
    std::uint16_t right = 0;
    std::int64_t utime = 0;  // [us]
  };
  [[nodiscard]] bool is_possible(const Counts& from, const Counts& to) const;

  WheelOdometryParams params_;
  Pose2 odom_from_robot_;
  std::optional<Counts> last_;
  std::optional<Counts> candidate_;  // where refused readings agree to be
  int candidate_count_ = 0;
  double distance_ = 0.0;         // [m] since the twist was measured
  double turn_ = 0.0;             // [rad]
  std::int64_t measured_at_ = 0;  // [us]; 0 = not yet
  double linear_ = 0.0;
  double angular_ = 0.0;
};

}  // namespace luminav
