#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "drivers/base/line/byte_stream.hpp"
#include "drivers/base/line/retry_schedule.hpp"
#include "drivers/create2/oi/sensor_reading.hpp"
#include "drivers/create2/oi/stream_parser.hpp"

namespace luminav {

/// Readings, and when they were taken.
struct TimedReading {
  SensorReading reading;
  std::int64_t utime = 0;  // [us]
};

/// What happened on the line since it was asked last.
struct Create2Events {
  bool connected = false;  // the stream has begun, or begun again
  std::vector<TimedReading> readings;
  int undecodable = 0;  // frames that passed the checksum and made no sense
};

/// The line to a Create 2: opens it, starts the interface and the sensor stream, and does it all again with growing
/// delays when the line is lost. Never waits; `now` is what the caller's clock says [us].
class Create2Link {
 public:
  explicit Create2Link(OpenStream open_stream) : open_stream_(std::move(open_stream)) {}

  Create2Events poll(std::int64_t now);
  /// Queues a command behind those that wait.
  void send(const std::vector<std::uint8_t>& bytes);
  /// Writes what the line takes now.
  void flush();
  /// Drops what waits, but for the rest of a command that is half written.
  void drop_waiting();
  /// Writes what waits and this, then closes the line.
  void close_with(const std::vector<std::uint8_t>& bytes);
  /// Leaves the line to somebody else who uses it, and begins anew after `pause` [us].
  void begin_anew(std::int64_t now, std::int64_t pause, const std::string& why);

  [[nodiscard]] int descriptor() const { return stream_ ? stream_->descriptor() : -1; }
  /// Grows each time the line is opened.
  [[nodiscard]] int openings() const { return openings_; }
  /// Readings arrive.
  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] bool is_idle() const { return waiting_.empty(); }
  [[nodiscard]] std::int64_t bad_frames() const { return parser_.bad_frames(); }
  /// Why nothing arrives, one sentence.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

 private:
  void open(std::int64_t now);
  void lose(std::int64_t now, const std::string& why);
  void read(std::int64_t now, Create2Events& events);
  void request_stream(std::int64_t now);

  OpenStream open_stream_;
  std::unique_ptr<ByteStream> stream_;
  StreamParser parser_;
  std::deque<std::vector<std::uint8_t>> waiting_;
  std::size_t written_ = 0;  // of the first that waits
  bool connected_ = false;
  std::string trouble_ = "not connected yet";
  int openings_ = 0;
  RetrySchedule retry_;
  std::int64_t last_request_ = 0;  // [us]
  std::int64_t last_frame_ = 0;    // [us] or when the line was opened
};

}  // namespace luminav
