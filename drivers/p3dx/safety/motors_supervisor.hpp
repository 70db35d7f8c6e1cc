#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/p3dx/arcos/information_packet.hpp"

namespace luminav {

/// Compares the wish for motors with what the robot says. A lost ENABLE is sent again at 1 Hz; whoever switches the
/// motors off at the robot is not fought with, and after its stop button a fresh request is needed.
class MotorsSupervisor {
 public:
  explicit MotorsSupervisor(bool enable_at_start) : wish_(enable_at_start) {}

  /// A session has begun; motors are off then.
  void on_connected();
  void request(bool enable);
  /// To be called with each information packet: the value for ENABLE to send now, if any.
  std::optional<bool> update(const InformationPacket& packet, std::int64_t now);

  /// Why the motors are off, one sentence; "" when they are on.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] bool wish() const { return wish_; }

 private:
  std::optional<bool> send(bool enable, std::int64_t now);

  bool wish_;
  bool seen_on_ = false;  // since the last request or connection
  bool seen_off_ = false;
  int off_count_ = 0;  // packets in a row: one alone may be damaged
  int on_count_ = 0;
  int attempts_ = 0;
  bool button_ = false;
  std::int64_t last_sent_ = 0;  // [us] 0 = may send now
  std::string reason_;
};

}  // namespace luminav
