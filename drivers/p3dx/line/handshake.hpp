#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

namespace luminav {

/// The three SYNCs that begin a session, with what robots do instead of answering: silence, a session still open, a
/// wrong count of SYNCs.
class Handshake {
 public:
  void start(std::int64_t now);
  /// The frame to send now, if any. `now` [us].
  std::optional<std::vector<std::uint8_t>> poll(std::int64_t now);
  void on_packet(const PacketView& packet, std::int64_t now);

  /// The robot has said who it is.
  [[nodiscard]] bool complete() const { return identity_.has_value(); }
  /// Nobody answers, or nobody sensibly: another rate or another time.
  [[nodiscard]] bool exhausted() const { return exhausted_; }
  /// Something that speaks the protocol was heard.
  [[nodiscard]] bool heard() const { return heard_; }
  [[nodiscard]] const RobotIdentity& identity() const { return *identity_; }

 private:
  void restart(std::int64_t at);

  std::uint8_t step_ = 0;  // the SYNC to be answered
  int silent_tries_ = 0;   // in a row
  int tries_ = 0;
  bool close_first_ = false;  // a session is still open
  bool heard_ = false;
  bool exhausted_ = false;
  std::int64_t due_ = 0;  // [us] when to send next
  std::optional<RobotIdentity> identity_;
};

}  // namespace luminav
