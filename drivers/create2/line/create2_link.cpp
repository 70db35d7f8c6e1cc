#include "drivers/create2/line/create2_link.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace luminav {
namespace {

constexpr std::int64_t kFramePeriod = 15'000;       // [us]
constexpr std::int64_t kRequestPeriod = 1'000'000;  // [us] a robot that is switched on later hears it then
constexpr std::int64_t kAnswerTime = 300'000;       // [us] twenty frames missing
constexpr std::int64_t kLostTime = 5'000'000;       // [us] then the line is opened anew

/// Frames that were held back arrive together; each was taken a period before the next.
void spread_stamps(std::vector<TimedReading>& readings) {
  for (std::size_t i = readings.size(); i-- > 1;) {
    readings[i - 1].utime = std::min(readings[i - 1].utime, readings[i].utime - kFramePeriod);
  }
}

}  // namespace

Create2Events Create2Link::poll(std::int64_t now) {
  Create2Events events;
  if (!stream_) {
    if (!retry_.is_due(now)) {
      return events;
    }
    open(now);
  }
  if (stream_) {
    read(now, events);
  }
  if (!events.readings.empty()) {
    spread_stamps(events.readings);
    events.connected = !connected_;
    connected_ = true;
    retry_.succeed();
    last_frame_ = now;
  } else if (stream_ && now - last_frame_ > kAnswerTime) {
    if (connected_ || trouble_.empty()) {
      trouble_ = "the robot does not answer: is it switched on?";
    }
    connected_ = false;
    if (now - last_frame_ > kLostTime) {
      lose(now, trouble_);
    } else if (now - last_request_ > kRequestPeriod) {
      request_stream(now);
    }
  }
  flush();
  return events;
}

void Create2Link::open(std::int64_t now) {
  try {
    stream_ = open_stream_();
  } catch (const std::runtime_error& error) {
    lose(now, error.what());
    return;
  }
  ++openings_;
  parser_.clear();
  waiting_.clear();
  written_ = 0;
  last_frame_ = now;
  trouble_ = "the robot does not answer: is it switched on?";
  request_stream(now);
}

void Create2Link::request_stream(std::int64_t now) {
  last_request_ = now;
  send(encode_opcode(OiOpcode::kStart));
  send(encode_stream_request(wanted_readings()));
}

void Create2Link::lose(std::int64_t now, const std::string& why) {
  trouble_ = why;
  if (stream_) {
    stream_->close();
    stream_.reset();
  }
  connected_ = false;
  waiting_.clear();
  written_ = 0;
  retry_.fail(now);
}

void Create2Link::begin_anew(std::int64_t now, std::int64_t pause, const std::string& why) {
  if (stream_) {
    lose(now, why);
    retry_.wait_until(now + pause);
  }
}

void Create2Link::read(std::int64_t now, Create2Events& events) {
  static const std::size_t size = readings_size();
  constexpr double kBitsPerByte = 10.0;  // 8N1
  const double on_the_line =
      stream_->baud() > 0 ? 1e6 * kBitsPerByte * static_cast<double>(size + 3) / stream_->baud() : 0.0;
  std::array<std::uint8_t, 4096> bytes;
  constexpr int kMaxReads = 16;  // a flood must not starve the timers
  for (int i = 0; i < kMaxReads; ++i) {
    const std::size_t count = stream_->read(bytes);
    parser_.push(std::span(bytes).first(count));
    while (const auto payload = parser_.next(size)) {
      if (const auto reading = decode_readings(*payload)) {
        events.readings.push_back({*reading, now - static_cast<std::int64_t>(on_the_line)});
      } else {
        ++events.undecodable;
      }
    }
    if (count < bytes.size()) {
      break;
    }
  }
  if (!stream_->is_open()) {
    lose(now, stream_->failure());
  }
}

void Create2Link::send(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kLongestQueue = 32;
  if (stream_ && waiting_.size() < kLongestQueue) {
    waiting_.push_back(bytes);
  }
}

void Create2Link::flush() {
  while (stream_ && !waiting_.empty()) {
    const auto rest = std::span<const std::uint8_t>(waiting_.front()).subspan(written_);
    const std::size_t count = stream_->write(rest);
    written_ += count;
    if (count < rest.size()) {
      return;
    }
    waiting_.pop_front();
    written_ = 0;
  }
}

void Create2Link::drop_waiting() {
  waiting_.resize(written_ > 0 ? 1 : 0);
}

void Create2Link::close_with(const std::vector<std::uint8_t>& bytes) {
  drop_waiting();
  send(bytes);
  flush();
  if (stream_) {
    stream_->close();
    stream_.reset();
  }
  connected_ = false;
}

}  // namespace luminav
