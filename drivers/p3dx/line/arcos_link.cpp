#include "drivers/p3dx/line/arcos_link.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <stdexcept>

#include "drivers/p3dx/arcos/arcos_commands.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kPastWatchdog = 2'200'000;          // [us] a controller at another rate has calmed down by then
constexpr std::int64_t kPulsePeriod = 400'000;             // [us] ARIA: 0.5 s
constexpr std::int64_t kConfigurationRetry = 500'000;      // [us]
constexpr std::int64_t kConfigurationTime = 1'000'000;     // [us] ARIA waits as long
constexpr std::int64_t kFirstInformationTime = 2'000'000;  // [us]
constexpr std::int64_t kAnswerTime = 500'000;              // [us] five packets missing: not answering
constexpr std::int64_t kLostTime = 2'500'000;              // [us] then the session is begun anew
constexpr std::int64_t kRateSwitchPause = 50'000;  // [us] HOSTBAUD takes 9 ms at 9600; R2's driver needs a pause
constexpr std::int64_t kRateSwitchTime = 900'000;  // [us] ARIA waits as long for a packet at the new rate
constexpr std::int64_t kPacketPause = 40'000;      // [us] robots send a packet in one go

}  // namespace

ArcosLink::ArcosLink(OpenStream open_stream, const LinkParams& params)
    : open_stream_(std::move(open_stream)), params_(params), rates_(params.baud, params.fast_baud) {}

LinkEvents ArcosLink::poll(std::int64_t now) {
  LinkEvents events;
  if (state_ == State::kClosed) {
    if (!retry_.is_due(now)) {
      return events;
    }
    open(now);
  }
  if (stream_) {
    read(now, events);
  }
  switch (state_) {
    case State::kClosed:
      break;
    case State::kSyncing:
      run_handshake(now);
      break;
    case State::kConfiguring:
      run_configuration(now, events);
      break;
    case State::kSwitchingRate:
      run_rate_switch(now);
      break;
    case State::kConnected:
      keep_alive(now);
      break;
  }
  flush(now);
  return events;
}

void ArcosLink::open(std::int64_t now) {
  try {
    stream_ = open_stream_();
  } catch (const std::runtime_error& error) {
    lose(now, error.what());
    return;
  }
  ++openings_;
  parser_.clear();
  drop_waiting();
  rates_.restart();
  state_ = State::kSyncing;
  handshake_.start(now);
}

void ArcosLink::lose(std::int64_t now, const std::string& why) {
  trouble_ = why;
  if (stream_) {
    stream_->close();
    stream_.reset();
  }
  state_ = State::kClosed;
  answering_ = false;
  drop_waiting();
  retry_.fail(now);
}

void ArcosLink::begin_anew(std::int64_t now, std::int64_t pause, const std::string& why) {
  if (state_ != State::kClosed) {
    lose(now, why);
    retry_.wait_until(now + pause);
  }
}

double ArcosLink::byte_time() const {
  constexpr double kBitsPerByte = 10.0;  // 8N1
  return stream_ && stream_->baud() > 0 ? 1e6 * kBitsPerByte / stream_->baud() : 0.0;
}

void ArcosLink::read(std::int64_t now, LinkEvents& events) {
  std::array<std::uint8_t, 4096> bytes;
  constexpr int kMaxReads = 16;  // a flood must not starve the timers
  for (int i = 0; i < kMaxReads && stream_; ++i) {
    const std::size_t count = stream_->read(bytes);
    parser_.push(std::span(bytes).first(count), now, byte_time());
    while (const auto packet = parser_.next()) {
      on_packet(*packet, now, events);
      if (!stream_) {
        return;
      }
    }
    if (count < bytes.size()) {
      break;
    }
  }
  if (stream_ && !stream_->is_open()) {
    lose(now, stream_->failure());
    return;
  }
  if (parser_.has_partial() && now - parser_.last_arrival() > kPacketPause) {
    parser_.give_up_partial();
  }
}

void ArcosLink::on_packet(const PacketView& packet, std::int64_t now, LinkEvents& events) {
  last_packet_ = now;
  if (state_ == State::kSyncing) {
    handshake_.on_packet(packet, now);
    return;
  }
  if (packet.type == packet_type::kResetA || packet.type == packet_type::kResetB) {
    lose(now, "the robot's controller was reset");
    return;
  }
  if (packet.type == packet_type::kSync0 && state_ == State::kConnected) {
    lose(now, "the robot has closed the session");  // it took a keep-alive for the beginning of a handshake
    return;
  }
  if (packet.type == packet_type::kConfiguration) {
    if (const auto configuration = decode_configuration(packet.payload)) {
      configuration_ = *configuration;
      has_configuration_ = true;
      events.configured = true;
    }
  } else if (is_information(packet.type)) {
    if (auto information = decode_information(packet.type, packet.payload)) {
      last_information_ = now;
      if (state_ == State::kConnected) {
        answering_ = true;
        events.information.push_back({std::move(*information), packet.header_utime});
      }
    } else {
      ++events.undecodable;
    }
  }
}

void ArcosLink::run_handshake(std::int64_t now) {
  if (auto frame = handshake_.poll(now)) {
    send(std::move(*frame));
  }
  if (handshake_.complete()) {
    begin_session(now);
  } else if (handshake_.exhausted()) {
    try_next_rate(now);
  }
}

void ArcosLink::try_next_rate(std::int64_t now) {
  if (stream_->baud() == 0) {
    lose(now, handshake_.heard() ? "the robot does not complete the handshake" : "the robot does not answer");
    return;
  }
  if (!rates_.advance()) {
    lose(now, "the robot does not answer at any rate from 9600 to 115200 baud");
    retry_.wait_until(now + kPastWatchdog);
    return;
  }
  stream_->set_baud(rates_.current());
  parser_.clear();
  drop_waiting();
  handshake_.start(now);
}

void ArcosLink::begin_session(std::int64_t now) {
  identity_ = handshake_.identity();
  std::string subclass = identity_.subclass;
  std::transform(subclass.begin(), subclass.end(), subclass.begin(), [](unsigned char c) { return std::tolower(c); });
  if (!subclass.starts_with("p3dx") && !params_.assume_p3dx_sh) {
    send(encode_command(ArcosCommand::kClose));
    flush(now);
    lose(now,
         "the robot is a \"" + identity_.subclass + "\", not a p3dx; assume_p3dx_sh = true drives it as a p3dx-sh");
    retry_.wait_until(now + RetrySchedule::kLongest);
    return;
  }
  state_ = State::kConfiguring;
  state_since_ = now;
  last_request_ = now;
  last_information_ = 0;
  configuration_ = ConfigurationPacket();
  has_configuration_ = false;
  rates_.begin_session();
  send(encode_command(ArcosCommand::kOpen));
  send(encode_command(ArcosCommand::kConfiguration));
}

void ArcosLink::run_configuration(std::int64_t now, LinkEvents& events) {
  const std::int64_t elapsed = now - state_since_;
  if (elapsed > kFirstInformationTime) {
    lose(now, "the robot has opened the session and sends no information");
    return;
  }
  const bool settled = has_configuration_ || elapsed > kConfigurationTime;
  if (!settled && now - last_request_ >= kConfigurationRetry) {
    last_request_ = now;
    send(encode_command(ArcosCommand::kConfiguration));
  }
  if (!settled || last_information_ == 0) {
    return;
  }
  constexpr int kCanSwitch = 2;
  if (rates_.wants_fast(stream_->baud()) && has_configuration_ && configuration_.auto_baud == kCanSwitch) {
    state_ = State::kSwitchingRate;
    state_since_ = now;
    send(encode_command(ArcosCommand::kHostBaud, code_of_baud(rates_.switch_to_fast())));
    return;
  }
  state_ = State::kConnected;
  answering_ = true;
  retry_.succeed();
  last_information_ = now;
  trouble_.clear();
  events.connected = true;
}

void ArcosLink::run_rate_switch(std::int64_t now) {
  const std::int64_t elapsed = now - state_since_;
  if (elapsed < kRateSwitchPause) {
    return;
  }
  if (stream_->baud() != params_.fast_baud) {
    stream_->set_baud(params_.fast_baud);
    parser_.clear();
    last_packet_ = 0;
    send(encode_command(ArcosCommand::kPulse));
  } else if (last_packet_ != 0 || elapsed > kRateSwitchTime) {
    if (last_packet_ == 0) {
      // Nobody there: the robot did not follow. Back to the rate that worked.
      stream_->set_baud(rates_.current());
      parser_.clear();
    }
    state_ = State::kConfiguring;
    state_since_ = now;
    last_information_ = 0;
  }
}

void ArcosLink::keep_alive(std::int64_t now) {
  const std::int64_t silence = now - last_information_;
  answering_ = silence <= kAnswerTime;
  if (silence > kLostTime) {
    lose(now, "the robot has stopped answering");
    return;
  }
  if (now - queue_.last_sent() >= kPulsePeriod && queue_.size() == 0) {
    send(encode_command(ArcosCommand::kPulse));
  }
}

void ArcosLink::close_with(const std::vector<std::vector<std::uint8_t>>& frames) {
  if (stream_ && stream_->is_open() && state_ != State::kSyncing) {
    queue_.finish_frame(*stream_);
    for (const std::vector<std::uint8_t>& frame : frames) {
      stream_->write(frame);
    }
  }
  lose(0, "closed");
  retry_.wait_until(std::numeric_limits<std::int64_t>::max());
}

}  // namespace luminav
