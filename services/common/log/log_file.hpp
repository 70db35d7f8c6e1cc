#pragma once

#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {

/// One message as lcm-logger wrote it.
struct LogEvent {
  std::int64_t utime = 0;  // [us] since the epoch, when it was received
  std::string channel;
  std::vector<std::uint8_t> data;

  /// First eight bytes: the type's fingerprint; 0 for shorter data.
  [[nodiscard]] std::uint64_t fingerprint() const;
};

/// What stands before an event's data of `size` bytes.
std::string log_event_head(std::int64_t number, std::int64_t utime, std::string_view channel, std::size_t size);

/// Reads LCM logs event by event. Own instead of lcm::LogFile because that one hides where a log is damaged: this one
/// uses a cut log up to the cut, goes on behind damaged bytes, and says so.
class LogReader {
 public:
  /// Throws std::runtime_error with one sentence for a file that cannot be read, is empty or is no LCM log.
  explicit LogReader(const std::string& file);

  /// False at the end; `event` is then unchanged.
  [[nodiscard]] bool next(LogEvent& event);

  /// From now on events of other channels come without their data: pictures that nobody looks at cost nothing.
  void load_only(std::set<std::string> channels) { wanted_ = std::move(channels); }
  void load_all() { wanted_.reset(); }
  /// Goes on reading there; `position` is one that position() gave.
  void go_to(std::uint64_t position);

  /// Size of the file [bytes] and how much of it has been read.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t position() const { return position_; }
  /// True once the end was found inside an event.
  [[nodiscard]] bool is_cut() const { return cut_; }
  /// Bytes passed over because no event began there.
  [[nodiscard]] std::uint64_t skipped() const { return skipped_; }
  /// One sentence for the last line of a report: "" when the log is whole.
  [[nodiscard]] std::string damage() const;

 private:
  [[nodiscard]] bool read(std::uint8_t* target, std::size_t count);
  [[nodiscard]] bool find_sync();
  /// The log ends inside an event: false.
  bool end_cut();

  struct Place {
    std::uint64_t position = 0;
    std::uint64_t skipped = 0;
  };

  std::string file_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;  // bytes of whole events and skipped bytes
  std::uint64_t skipped_ = 0;
  std::uint64_t events_ = 0;
  bool cut_ = false;
  std::optional<Place> unfinished_;              // of an event that would reach beyond the file, no other behind it yet
  std::optional<std::set<std::string>> wanted_;  // nothing: all
};

/// Writes events as lcm-logger does, byte for byte the same for the same events, and sums them up with SHA-256.
class LogWriter {
 public:
  /// `file` "" = only the checksum; "-", a device or a pipe as WholeFile writes them. The file is there when `finish`
  /// has returned; a writer that is destroyed before leaves nothing. Throws std::runtime_error when it cannot be
  /// written.
  explicit LogWriter(const std::string& file);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  void write(std::int64_t utime, std::string_view channel, const void* data, std::size_t size);
  /// Ends the log and returns its SHA-256 in hexadecimal digits.
  std::string finish();

 private:
  void put(const void* data, std::size_t size);

  struct Digest;
  std::unique_ptr<Digest> digest_;
  std::optional<WholeFile> file_;
  std::string pending_;  // many small pieces make one that is written
  std::int64_t events_ = 0;
};

}  // namespace luminav
