#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/line/byte_stream.hpp"
#include "drivers/base/line/retry_schedule.hpp"
#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"
#include "drivers/p3dx/line/handshake.hpp"
#include "drivers/p3dx/line/line_rates.hpp"
#include "drivers/p3dx/line/send_queue.hpp"

namespace luminav {

struct LinkParams {
  int baud = 9600;              // [bit/s] tried first on a serial line
  int fast_baud = 0;            // [bit/s] to switch to once connected; 0 = stay
  bool assume_p3dx_sh = false;  // go on with a robot of unknown subclass
};

/// A standard information packet and when its header arrived.
struct ReceivedInformation {
  InformationPacket packet;
  std::int64_t utime = 0;  // [us]
};

/// What happened on the line since it was asked last.
struct LinkEvents {
  bool connected = false;   // a session has begun
  bool configured = false;  // a configuration packet has come
  std::vector<ReceivedInformation> information;
  int undecodable = 0;  // information packets that passed the checksum and made no sense
};

/// The session with the robot: opens the line, finds its rate, shakes hands, keeps alive, and does it all again with
/// growing delays when the line is lost. Never waits; `now` is what the caller's clock says [us].
class ArcosLink {
 public:
  ArcosLink(OpenStream open_stream, const LinkParams& params);

  LinkEvents poll(std::int64_t now);
  /// Queues a frame; frames leave at a pace that the robot can follow.
  void send(std::vector<std::uint8_t> frame) { queue_.push(std::move(frame)); }
  /// Writes what may leave now.
  void flush(std::int64_t now) { queue_.flush(stream_.get(), now); }
  /// Writes frames at once and in whole before anything that waits, then closes the line.
  void close_with(const std::vector<std::vector<std::uint8_t>>& frames);
  /// Drops frames that wait, such as a motion command from before a gap.
  void drop_waiting() { queue_.drop_waiting(stream_.get()); }
  /// Leaves a session that somebody else has ended on this line, and begins another after `pause` [us].
  void begin_anew(std::int64_t now, std::int64_t pause, const std::string& why);

  [[nodiscard]] int descriptor() const { return stream_ ? stream_->descriptor() : -1; }
  /// Grows each time the line is opened.
  [[nodiscard]] int openings() const { return openings_; }
  /// The robot has a session with us, and its packets arrive.
  [[nodiscard]] bool connected() const { return state_ == State::kConnected && answering_; }
  /// The same session as before, though its packets may not arrive for a moment.
  [[nodiscard]] bool in_session() const { return state_ == State::kConnected; }
  [[nodiscard]] std::size_t waiting_frames() const { return queue_.size(); }
  [[nodiscard]] const RobotIdentity& identity() const { return identity_; }
  /// As the robot says, else those of a p3dx-sh.
  [[nodiscard]] const ConfigurationPacket& configuration() const { return configuration_; }
  [[nodiscard]] bool has_configuration() const { return has_configuration_; }
  [[nodiscard]] const PacketParser& parser() const { return parser_; }
  /// Why there is no session, one sentence.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

 private:
  enum class State { kClosed, kSyncing, kConfiguring, kSwitchingRate, kConnected };

  void open(std::int64_t now);
  void lose(std::int64_t now, const std::string& why);
  void read(std::int64_t now, LinkEvents& events);
  void on_packet(const PacketView& packet, std::int64_t now, LinkEvents& events);
  void run_handshake(std::int64_t now);
  void try_next_rate(std::int64_t now);
  void begin_session(std::int64_t now);
  void run_configuration(std::int64_t now, LinkEvents& events);
  void run_rate_switch(std::int64_t now);
  void keep_alive(std::int64_t now);
  [[nodiscard]] double byte_time() const;

  OpenStream open_stream_;
  LinkParams params_;
  std::unique_ptr<ByteStream> stream_;
  PacketParser parser_;
  Handshake handshake_;
  State state_ = State::kClosed;
  std::string trouble_ = "not connected yet";
  int openings_ = 0;
  RetrySchedule retry_;
  LineRates rates_;
  RobotIdentity identity_;
  ConfigurationPacket configuration_;
  bool has_configuration_ = false;
  bool answering_ = false;
  std::int64_t state_since_ = 0;       // [us]
  std::int64_t last_request_ = 0;      // [us] of the configuration
  std::int64_t last_information_ = 0;  // [us]
  std::int64_t last_packet_ = 0;       // [us]
  SendQueue queue_;
};

}  // namespace luminav
