#pragma once

#include <cstdint>
#include <optional>

#include "drivers/p3dx/arcos/information_packet.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

struct DeadReckoningParams {
  double distance_factor = 1.0;               // [mm per unit] of the robot's x and y
  double maximum_speed = 1.5;                 // [m/s] a larger step is refused
  double maximum_turn_rate = radians(360.0);  // [rad/s]
  double wheel_factor = 0.0056;  // [rad/s per mm/s] of half the difference of the wheels, where no turn rate is sent
};

/// Odometry from the wrapping registers of the robot: shortest differences modulo 32768 and 4096, summed as integers,
/// so nothing is lost by rounding over any number of wraps. The first packet is the reference; the frame is the
/// robot's own.
class DeadReckoning {
 public:
  enum class Verdict {
    kAccepted,
    kRefused,  // the step is more than the robot can do: a damaged packet
    kJumped,   // several agree on another place: the registers were reset; a new reference, motion across it unknown
  };

  explicit DeadReckoning(const DeadReckoningParams& params) : params_(params) {}

  /// The next packet is a new reference.
  void restart() { last_.reset(); }
  Verdict update(const InformationPacket& packet, std::int64_t utime);

  [[nodiscard]] Pose2 odom_from_robot() const;
  [[nodiscard]] double linear() const { return linear_; }    // [m/s]
  [[nodiscard]] double angular() const { return angular_; }  // [rad/s]
  [[nodiscard]] std::int64_t utime() const { return last_ ? last_->utime : 0; }

 private:
  struct Registers {
    int x = 0;
    int y = 0;
    int heading = 0;
    std::int64_t utime = 0;  // [us]
  };
  [[nodiscard]] bool is_possible(const Registers& from, const Registers& to) const;
  void take_reference(const Registers& registers);

  DeadReckoningParams params_;
  std::optional<Registers> last_;
  std::optional<Registers> candidate_;  // where refused packets agree to be
  int candidate_count_ = 0;
  std::int64_t x_ = 0;  // units, not wrapped
  std::int64_t y_ = 0;
  std::int64_t heading_ = 0;  // 4096 per turn, not wrapped
  double linear_ = 0.0;
  double angular_ = 0.0;
};

}  // namespace luminav
