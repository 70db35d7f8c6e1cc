#include "drivers/p3dx/line/handshake.hpp"

#include "drivers/p3dx/arcos/arcos_commands.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kReplyTime = 400'000;   // [us] clients in use wait 200 ms to 1 s
constexpr std::int64_t kClosePause = 300'000;  // [us] the last packets of the old session pass by
constexpr int kSilentTries = 4;
constexpr int kTries = 20;

}  // namespace

void Handshake::start(std::int64_t now) {
  *this = Handshake();
  due_ = now;
}

void Handshake::restart(std::int64_t at) {
  step_ = 0;
  due_ = at;
}

std::optional<std::vector<std::uint8_t>> Handshake::poll(std::int64_t now) {
  if (complete() || exhausted_ || now < due_) {
    return std::nullopt;
  }
  if (close_first_) {
    close_first_ = false;
    restart(now + kClosePause);
    return encode_command(ArcosCommand::kClose);
  }
  if (silent_tries_ >= kSilentTries || tries_ >= kTries) {
    exhausted_ = true;
    return std::nullopt;
  }
  if (silent_tries_ > 1) {
    step_ = 0;  // an answer was lost on the way, and who knows where the robot is
  }
  ++silent_tries_;
  ++tries_;
  due_ = now + kReplyTime;
  return encode_packet(step_);
}

void Handshake::on_packet(const PacketView& packet, std::int64_t now) {
  if (complete() || exhausted_) {
    return;
  }
  heard_ = true;
  if (is_information(packet.type)) {
    // An earlier session is still open. While its last packets pass by after CLOSE, they are no news.
    if (silent_tries_ > 0) {
      close_first_ = true;
      silent_tries_ = 0;
      due_ = now;
    }
  } else if (packet.type == packet_type::kResetB) {
    silent_tries_ = 0;
    restart(now + kClosePause);
  } else if (packet.type == step_) {
    silent_tries_ = 0;
    due_ = now;
    if (step_ < packet_type::kSync2) {
      ++step_;
    } else if (!packet.payload.empty()) {
      identity_ = decode_identity(packet.payload);
    }
  }
}

}  // namespace luminav
