#include "drivers/p3dx/line/arcos_link.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <stdexcept>

#include "drivers/p3dx/arcos/arcos_commands.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kFirstRetry = 50'000;  // [us]
constexpr int kQuickRetries = 20;             // a guardian of a driver that died holds the line for less than a second
constexpr std::int64_t kLongestRetry = 2'000'000;          // [us] driving again within 3 s of the line being back
constexpr std::int64_t kPastWatchdog = 2'200'000;          // [us] a controller at another rate has calmed down by then
constexpr std::int64_t kFramePeriod = 5'000;               // [us] a robot may lose commands that follow faster
constexpr double kFrameBurst = 4.0;                        // motion commands, and a change right behind them
constexpr std::int64_t kPulsePeriod = 400'000;             // [us] ARIA: 0.5 s
constexpr std::int64_t kConfigurationRetry = 500'000;      // [us]
constexpr std::int64_t kConfigurationTime = 1'000'000;     // [us] ARIA waits as long
constexpr std::int64_t kFirstInformationTime = 2'000'000;  // [us]
constexpr std::int64_t kAnswerTime = 500'000;              // [us] five packets missing: not answering
constexpr std::int64_t kLostTime = 2'500'000;              // [us] then the session is begun anew
constexpr std::int64_t kRateSwitchPause = 50'000;  // [us] HOSTBAUD takes 9 ms at 9600; R2's driver needs a pause
constexpr std::int64_t kRateSwitchTime = 900'000;  // [us] ARIA waits as long for a packet at the new rate
constexpr std::int64_t kPacketPause = 40'000;      // [us] robots send a packet in one go
constexpr std::size_t kLongestQueue = 64;

}  // namespace

ArcosLink::ArcosLink(OpenStream open_stream, const LinkParams& params)
    : open_stream_(std::move(open_stream)), params_(params), rates_{params.baud} {
  // A robot keeps the rate that an earlier session has set.
  for (const int rate : {params.fast_baud, 9600, 38400, 19200, 115200, 57600}) {
    if (rate != 0 && std::find(rates_.begin(), rates_.end(), rate) == rates_.end()) {
      rates_.push_back(rate);
    }
  }
}

LinkEvents ArcosLink::poll(std::int64_t now) {
  LinkEvents events;
  if (state_ == State::kClosed) {
    if (now < retry_at_) {
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
  rate_index_ = 0;
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
  const std::int64_t delay = kFirstRetry << std::clamp(failures_ - kQuickRetries, 0, 6);
  ++failures_;
  retry_at_ = now + std::min(delay, kLongestRetry);
}

void ArcosLink::begin_anew(std::int64_t now, std::int64_t pause, const std::string& why) {
  if (state_ != State::kClosed) {
    lose(now, why);
    retry_at_ = now + pause;
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
    last_byte_ = count > 0 ? now : last_byte_;
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
  if (parser_.has_partial() && now - last_byte_ > kPacketPause) {
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
  if (++rate_index_ >= rates_.size()) {
    lose(now, "the robot does not answer at any rate from 9600 to 115200 baud");
    retry_at_ = std::max(retry_at_, now + kPastWatchdog);
    return;
  }
  stream_->set_baud(rates_[rate_index_]);
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
    retry_at_ = now + kLongestRetry;
    return;
  }
  state_ = State::kConfiguring;
  state_since_ = now;
  last_request_ = now;
  last_information_ = 0;
  configuration_ = ConfigurationPacket();
  has_configuration_ = false;
  switched_rate_ = false;
  send(encode_command(ArcosCommand::kOpen));
  send(encode_command(ArcosCommand::kConfiguration));
}

bool ArcosLink::wants_fast_rate() const {
  constexpr int kCanSwitch = 2;
  return !switched_rate_ && stream_->baud() > 0 && params_.fast_baud > stream_->baud() && has_configuration_ &&
         configuration_.auto_baud == kCanSwitch;
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
  if (wants_fast_rate()) {
    switched_rate_ = true;
    state_ = State::kSwitchingRate;
    state_since_ = now;
    send(encode_command(ArcosCommand::kHostBaud, code_of_baud(params_.fast_baud)));
    return;
  }
  state_ = State::kConnected;
  answering_ = true;
  failures_ = 0;
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
  } else if (last_packet_ != 0) {
    state_ = State::kConfiguring;
    state_since_ = now;
    last_information_ = 0;
  } else if (elapsed > kRateSwitchTime) {
    // Nobody there: the robot did not follow. Back to the rate that worked.
    stream_->set_baud(rates_[rate_index_]);
    parser_.clear();
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
  if (now - last_sent_ >= kPulsePeriod && waiting_.empty()) {
    send(encode_command(ArcosCommand::kPulse));
  }
}

void ArcosLink::send(std::vector<std::uint8_t> frame) {
  if (waiting_.size() < kLongestQueue) {
    waiting_.push_back(std::move(frame));
  }
}

void ArcosLink::flush(std::int64_t now) {
  allowance_ = std::min(kFrameBurst, allowance_ + static_cast<double>(now - allowance_at_) / kFramePeriod);
  allowance_at_ = now;
  while (stream_ && !waiting_.empty() && (allowance_ >= 1.0 || written_ > 0)) {
    // All that may leave goes in one write: on a network each costs as much as the rest of a poll.
    std::vector<std::uint8_t> batch(waiting_.front().begin() + static_cast<std::ptrdiff_t>(written_),
                                    waiting_.front().end());
    double left = written_ > 0 ? allowance_ : allowance_ - 1.0;
    for (std::size_t i = 1; i < waiting_.size() && left >= 1.0; ++i, left -= 1.0) {
      batch.insert(batch.end(), waiting_[i].begin(), waiting_[i].end());
    }
    const std::size_t count = stream_->write(batch);
    count_as_written(count, now);
    if (count < batch.size()) {
      return;  // goes on with the byte that was not taken
    }
  }
}

void ArcosLink::count_as_written(std::size_t bytes, std::int64_t now) {
  while (bytes > 0) {
    if (written_ == 0) {
      allowance_ -= 1.0;
    }
    const std::size_t some = std::min(bytes, waiting_.front().size() - written_);
    bytes -= some;
    written_ += some;
    if (written_ == waiting_.front().size()) {
      written_ = 0;
      last_sent_ = now;
      waiting_.pop_front();
    }
  }
}

void ArcosLink::close_with(const std::vector<std::vector<std::uint8_t>>& frames) {
  if (stream_ && stream_->is_open() && state_ != State::kSyncing) {
    if (written_ > 0 && !waiting_.empty()) {
      stream_->write(std::span(waiting_.front()).subspan(written_));
    }
    for (const std::vector<std::uint8_t>& frame : frames) {
      stream_->write(frame);
    }
  }
  lose(0, "closed");
  retry_at_ = std::numeric_limits<std::int64_t>::max();
}

void ArcosLink::drop_waiting() {
  // A frame that has left in part must go on, or the robot would take the next one for its rest.
  if (written_ > 0 && stream_ && stream_->is_open() && !waiting_.empty()) {
    waiting_.resize(1);
    return;
  }
  waiting_.clear();
  written_ = 0;
}

}  // namespace luminav
