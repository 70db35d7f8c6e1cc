#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "services/common/log/log_file.hpp"

namespace luminav {

/// How one channel's replayed messages compare with the recorded ones, message by message in their order.
struct ChannelDivergence {
  std::int64_t recorded = 0;
  std::int64_t replayed = 0;
  std::int64_t identical = 0;  // byte for byte
  bool differs = false;
  std::int64_t first_utime = 0;  // [us] receive time of the first one that differs or is missing
  std::string first_what;        // the field with both values, or what is missing
};

/// Finds where a replay leaves the record.
class DivergenceWatch {
 public:
  void recorded(LogEvent event);
  void replayed(LogEvent event);
  /// Call once at the end: what one side has more is a difference.
  void finish();

  [[nodiscard]] const std::map<std::string, ChannelDivergence>& channels() const { return channels_; }
  /// Channel of the earliest difference; "" = none. Channels that were not recorded at all do not count.
  [[nodiscard]] std::string first_channel() const;

 private:
  struct Waiting {
    std::deque<LogEvent> recorded;
    std::deque<LogEvent> replayed;
  };
  void compare(const std::string& channel);
  void note(ChannelDivergence& divergence, std::int64_t utime, std::string what);

  std::map<std::string, ChannelDivergence> channels_;
  std::map<std::string, Waiting> waiting_;
};

}  // namespace luminav
