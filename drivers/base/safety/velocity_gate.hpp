#pragma once

#include <cstdint>
#include <string>

namespace luminav {

/// Twist of a differential drive.
struct DriveVelocity {
  double linear = 0.0;   // [m/s]
  double angular = 0.0;  // [rad/s]

  friend bool operator==(const DriveVelocity&, const DriveVelocity&) = default;
};

struct VelocityGateParams {
  double timeout = 0.3;          // [s] age at which a command is no longer obeyed
  double maximum_linear = 0.5;   // [m/s]
  double maximum_angular = 1.0;  // [rad/s]
};

/// Lets only fresh commands through: younger than the timeout by the stamp they answer, and of growing sequence within
/// a sender's session. A backlog is never fresh. A session is forgotten after a second without an accepted command.
class VelocityGate {
 public:
  explicit VelocityGate(const VelocityGateParams& params) : params_(params) {}

  struct Offer {
    std::int64_t utime = 0;    // [us] of the message that it answers
    std::int64_t session = 0;  // of the sender
    std::int32_t sequence = 0;
    double linear = 0.0;    // [m/s]
    double sideways = 0.0;  // [m/s]
    double angular = 0.0;   // [rad/s]
  };
  /// "" when taken, else why it is refused.
  std::string offer(const Offer& offer, std::int64_t now);
  /// What was taken is no longer obeyed, and commands answering anything before `now` are not either.
  void clear(std::int64_t now);
  void set_limits(double maximum_linear, double maximum_angular);

  [[nodiscard]] bool is_fresh(std::int64_t now) const;
  /// What to do now: on the arc that was asked for, as fast as the limits allow; nothing when nothing is fresh.
  [[nodiscard]] DriveVelocity velocity(std::int64_t now) const;
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  [[nodiscard]] const VelocityGateParams& params() const { return params_; }

 private:
  [[nodiscard]] std::string judge(const Offer& offer, std::int64_t now) const;

  VelocityGateParams params_;
  std::int64_t session_ = 0;
  std::int32_t sequence_ = 0;
  std::int64_t utime_ = 0;        // [us] of the command in force; 0 = none
  std::int64_t not_before_ = 0;   // [us]
  std::int64_t accepted_at_ = 0;  // [us] when the last command was taken
  DriveVelocity velocity_;
  std::int64_t refused_ = 0;
};

}  // namespace luminav
