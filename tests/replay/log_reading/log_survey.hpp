#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/common/log/log_file.hpp"
#include "tests/replay/log_reading/message_schema.hpp"

namespace luminav {

/// What a log holds on one channel. Receive times are the logger's, stamps the messages' own `utime`.
struct ChannelSurvey {
  std::string type;               // "" = no known type has its fingerprint
  std::uint64_t fingerprint = 0;  // of the first message
  std::int64_t count = 0;
  std::int64_t bytes = 0;
  std::int64_t first = 0;           // [us] received
  std::int64_t last = 0;            // [us] received
  std::vector<double> intervals;    // [s] between receive times
  double longest_gap = 0.0;         // [s]
  std::int64_t longest_gap_at = 0;  // [us] where it begins
  std::vector<double> latencies;    // [s] from stamp to receive time
  std::int64_t undecodable = 0;     // of another type than the first, or damaged
  std::int64_t out_of_order = 0;    // stamp older than one before
  std::int64_t lost = 0;            // by gaps of `sequence`
  std::int64_t restarts = 0;        // `sequence` began anew
  std::set<std::int64_t> sessions;
  bool mixed_senders = false;  // a session came back after another one: two senders on one channel

  [[nodiscard]] double rate() const;    // [Hz]
  [[nodiscard]] double jitter() const;  // [s] standard deviation of the intervals

  // of the message before
  std::optional<std::int64_t> newest_stamp;
  std::optional<std::int64_t> sequence;
  std::optional<std::int64_t> session;
};

/// Looks through a log once and says what is in it and what would make a replay differ.
class LogSurvey {
 public:
  void add(const LogEvent& event);

  [[nodiscard]] const std::map<std::string, ChannelSurvey>& channels() const { return channels_; }
  /// One sentence each: what makes a replay of this log differ from the drive, or impossible.
  [[nodiscard]] std::vector<std::string> objections() const;
  /// The table with its head, and those sentences.
  [[nodiscard]] std::string text() const;

 private:
  void follow_sequence(ChannelSurvey& channel, const LogEvent& event);
  void look_inside(const LogEvent& event);

  const MessageSchemas& schemas_ = MessageSchemas::built_in();
  std::map<std::string, ChannelSurvey> channels_;
  std::set<std::string> robots_;
  std::int64_t events_ = 0;
  std::int64_t first_ = 0;
  std::int64_t last_ = 0;
  std::int64_t backward_ = 0;       // receive times that went back
  bool tracking_at_start_ = false;  // the localizer had a pose before the log began
  std::int64_t saves_ = 0;          // MAP_COMMANDs that read or write files
};

}  // namespace luminav
